// SPDX-License-Identifier: MIT
// What moves as a whole: the bodies, hinges and shapes of a robot type in one fidelity, or of an object.
// Constant once made and shared by all robots alike. Only server/physics includes this file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/physics/wheel_drive.h"

namespace coopdyn {

/// A rigid body, with its place when the mechanism stands at the origin.
struct RigidBody {
  double mass_kg = 0;
  Matrix3 inertia_kg_m2 = Matrix3::Identity();  // about its centre of mass, in its own axes
  Pose X_RB;
};

/// A hinge between two bodies, in R.
struct Hinge {
  int parent = 0, child = 0;  // index into bodies
  Vector3 p_R = Vector3::Zero();
  Vector3 axis_R = Vector3::UnitY();
  int channel = -1;  // of the robot's channels, if a motor drives it
  double max_torque_nm = 0;
};

/// A robot's body 0 is its chassis; of fidelity rolling and planar it is all there is, with the axes of R and
/// its origin in the common centre of mass. A static object has no body; its only part stands in the world.
struct Mechanism {
  std::vector<RigidBody> bodies;
  std::vector<Hinge> hinges;
  std::vector<Part> parts;
  int joint_rows = 0;  // constraint rows of its hinges and motors
  int floor_rows = 0;  // of its contacts when it stands

  // Robots only.
  const RobotModel* model = nullptr;
  Fidelity fidelity = Fidelity::kFull;
  int shell = -1;       // the upright cylinder among `parts` that covers all others in plan; -1: none
  double radius_m = 0;  // of the vertical cylinder about R's z axis that holds it when upright
  double reach_m = 0;   // of the sphere about R's origin that holds it however its links turn
  double height_m = 0;
  std::optional<OneBodyDrive> drive;  // fidelity rolling and planar, if it has wheels

  bool one_body() const { return model != nullptr && fidelity != Fidelity::kFull; }
  bool planar() const { return fidelity == Fidelity::kPlanar; }
};

/// `model` on a floor with this friction. @pre masses and inertias are positive.
Mechanism MakeRobot(const RobotModel& model, Fidelity fidelity, double floor_friction, double gravity_m_s2);
Mechanism MakeObject(const WorldObject& object);

}  // namespace coopdyn
