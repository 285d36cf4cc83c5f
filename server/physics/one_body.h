// SPDX-License-Identifier: MIT
// A robot of fidelity rolling or planar: all links welded into one body, and what its wheels can do. Constant
// once made. Only server/physics includes this file.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "server/physics/part.h"
#include "server/state/scene.h"

namespace coopdyn {

/// The two wheels of a drive, equal and opposite each other.
struct WheelPair {
  double radius_m = 0;
  double half_track_m = 0;           // from R's z axis to the middle of each tread
  std::array<double, 2> friction{};  // of the treads: left, right
};

/// A robot type as one body. The body frame B has the axes of R; its origin is the centre of mass.
struct OneBody {
  const RobotModel* model = nullptr;
  bool planar = false;
  double mass_kg = 0;
  Matrix3 inertia_kg_m2 = Matrix3::Zero();  // about B's origin
  Vector3 p_RB = Vector3::Zero();
  std::vector<Part> parts;  // in B
  int shell = -1;           // the upright cylinder among `parts` that covers all others in plan; -1: none
  double radius_m = 0;      // of the vertical cylinder about R's z axis that holds it when upright
  double reach_m = 0;       // of the sphere about R's origin that holds it
  double height_m = 0;

  // The drive. Without wheels it is a body that can only be pushed.
  bool has_wheels = false;
  /// Stands on its own on wheels and casters: upright at z = 0 it is at rest.
  bool stands = false;
  WheelPair wheels;
  std::array<double, 2> load_n{};   // that each wheel carries at rest
  std::array<double, 2> drive_n{};  // the most that each wheel pushes along its rolling direction
  double sideways_n = 0;            // the most that both wheels hold against sideways forces
  double yaw_inertia_kg_m2 = 0;     // about the middle of the axle
  bool stalls = false;  // the motors give in before the wheels slip: a held robot's wheels stand still
  // Beyond these accelerations it slides sideways or lifts a wheel.
  double max_along_m_s2 = 0, max_across_m_s2 = 0;
};

/// The wheels of `model` as fidelity rolling and planar need them; else why they do not fit.
std::optional<WheelPair> FindWheels(const RobotModel& model, std::string& why);

/// `model` on a floor with this friction. @pre masses and inertias are positive.
OneBody MakeOneBody(const RobotModel& model, bool planar, double floor_friction, double gravity_m_s2);

}  // namespace coopdyn
