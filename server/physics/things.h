// SPDX-License-Identifier: MIT
// Everything that collides in a scene: robots and objects, with their bodies, joints and shapes. Built once;
// only `frozen` changes. Only server/physics includes this file.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/physics/limb_tree.h"
#include "server/physics/wheel_drive.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A rigid body, with its pose when the mechanism stands at the origin.
struct RigidBody {
  double mass_kg = 0;
  Matrix3 inertia_kg_m2 = Matrix3::Identity();  // about its centre of mass, in its own axes
  Pose X_RB;
};

/// A joint between the bodies of the two links that the model names.
struct Joint {
  const JointModel* model = nullptr;
  int channel = -1;       // of the robot's channels, if a motor drives it
  int limiter = -1;       // of the robot's channels: sets the joint's greatest effort; -1: none
  double max_effort = 0;  // of the motor
  int steers = -1;        // 0, 1: steers the left or right front wheel of the robot's drive; -1: neither
  int control = -1;       // of the robot's controls; -1: on no control board
  const BoardModel* board = nullptr;  // its control board; null: none
  std::vector<int> beyond;            // the bodies it moves, if their weight or inertia matters to its motor
};

/// The bodies, joints and shapes of a robot type in one fidelity, or of an object. Immutable and shared by
/// all robots of the kind. A robot's body 0 is its chassis. With fidelity rolling or planar, body 0 is the
/// only body, with the axes of R and its origin at the common centre of mass. A static object has no body;
/// its only part stands in the world.
struct Mechanism {
  std::vector<RigidBody> bodies;
  std::vector<Joint> joints;
  std::vector<Part> parts;
  LimbTree tree;       // of `bodies`
  int joint_rows = 0;  // constraint rows of joints and motors
  int floor_rows = 0;  // constraint rows of its floor contacts when it stands

  // Robots only.
  const RobotModel* model = nullptr;
  Fidelity fidelity = Fidelity::kFull;
  int shell = -1;  // index of the upright cylinder in `parts` that covers all other parts in plan; -1: none
  double radius_m = 0;  // of the cylinder about R's z axis that contains the upright robot
  double reach_m = 0;   // of the sphere about R's origin that contains the robot in every posture
  double height_m = 0, lowest_m = 0;  // z in R of the upright robot's highest and lowest point; lowest_m <= 0
  std::optional<OneBodyDrive> drive;  // fidelity rolling and planar, if it has wheels
  bool has_soft_parts = false;        // parts with a finite stiffness
  bool fixed_base = false;            // body 0 stands still in the world
  /// For each body of a robot with joints other than wheels: radius of the sphere about its centre of mass
  /// that contains its parts. Such a robot's space follows from its bodies, not from the radius, reach and
  /// height above.
  std::vector<double> limb_radii_m;

  bool one_body() const { return model != nullptr && fidelity != Fidelity::kFull; }
  /// Some of it yields where it touches. Wheels of a drive do not.
  bool is_soft() const { return has_soft_parts && !drive; }
  bool planar() const { return fidelity == Fidelity::kPlanar; }
  bool has_limbs() const { return !limb_radii_m.empty(); }
  /// One free body without joints or wheels: an object, or a robot that is solved like one.
  bool is_loose() const {
    return bodies.size() == 1 && joints.empty() && !drive && !fixed_base && !one_body() && !has_limbs();
  }
};

/// Makes `model`'s mechanism, on a floor with this friction.
/// @pre masses and inertias are positive
Mechanism MakeRobot(const RobotModel& model, Fidelity fidelity, double floor_friction, const Vector3& g_W);
Mechanism MakeObject(const WorldObject& object);

/// A robot or an object. Its own parts do not collide with each other.
struct Thing {
  // The members that each step reads are adjacent.
  int robot = -1;   // index into Scene::robots; -1: an object
  int object = -1;  // index into Scene::objects; -1: a robot
  const Mechanism* mechanism = nullptr;
  std::size_t first_channel = 0, channel_count = 0;  // of Frame::channels; count 0 for objects
  std::size_t first_control = 0, control_count = 0;  // of Frame::controls; count 0 for objects
  int first_body = 0;                                // of Frame::bodies; unused if static
  bool frozen = false;                               // held in place: nothing is joined to its bodies
  std::size_t pool = 0;  // of Things::pools: the kind of bodies that it needs in ODE

  // Robots only.
  double rest_z_m = 0;              // of a one-body robot: height of its centre of mass at rest
  Vector3 p_BR = Vector3::Zero();   // R's origin in the first body
  Vector3 up_B = Vector3::UnitZ();  // R's z axis in the first body

  BodyState fixed{};  // of a static object: its pose

  std::size_t body_count() const { return mechanism->bodies.size(); }
};

/// A thing and the states of its bodies.
struct Actor {
  const Thing& thing;
  const BodyState* bodies;

  std::span<const Part> parts() const { return thing.mechanism->parts; }
  PlacedPart Place(std::size_t part) const {
    const Part& of = thing.mechanism->parts[part];
    return {of, bodies[static_cast<std::size_t>(of.body)]};
  }
};

struct Things {
  std::vector<std::shared_ptr<const Mechanism>> mechanisms;  // PhysicsWorld::Rebuild() reuses them
  std::vector<Thing> all;  // dynamic objects, then robots from `first_robot` on, then static objects
  std::size_t first_robot = 0;
  std::size_t first_static = 0;
  /// Kinds of bodies in ODE: null for single bodies, else a mechanism with several bodies.
  std::vector<const Mechanism*> pools{nullptr};
  std::vector<BodyState> bodies;  // as Frame::bodies: the start states

  Actor ActorOf(std::size_t thing, std::span<const BodyState> bodies) const {
    const Thing& info = all[thing];
    if (thing >= first_static) return {info, &info.fixed};
    return {info, bodies.data() + info.first_body};
  }
};

/// Makes the things of `scene`, which must outlive them.
/// @pre all masses and inertias are positive
Things MakeThings(const Scene& scene);
/// Like MakeThings(scene), for a scene with the same floor and gravity as that of `before`: robots of a kind
/// that `before` has share its mechanism. `bodies` stays empty.
Things MakeThings(const Scene& scene, const Things& before);

/// Sets a body's orientation.
void Orient(BodyState& body, const Quaternion& q);

/// Start states of a thing's bodies, at rest, with the model's frame at `X_WR`.
std::vector<BodyState> StartBodies(const Mechanism& mechanism, const Pose& X_WR);
/// Start states of an object's bodies, with the object's initial twist.
std::vector<BodyState> StartBodies(const Mechanism& mechanism, const WorldObject& object);

/// A thing's kind and name (`robot robot1`, `box BOX_1`); its name alone; and the line that defines it.
std::string TitleOf(const Scene& scene, const Thing& thing);
const std::string& NameOf(const Scene& scene, const Thing& thing);
const SourceLine& WhereOf(const Scene& scene, const Thing& thing);

// Checks before the first step.

/// Reports robots whose model cannot be simulated (a link without mass). Call before MakeThings().
void CheckModels(const Scene& scene, Diagnostics& diagnostics);
/// Reports every dynamic thing that starts more than 1 mm inside another or below the floor, and by how much,
/// as an error. With `overlaps yes` in the scenario, the overlap is reported as mended, or as a warning if
/// the thing's middle is inside something fixed.
void CheckStart(const Scene& scene, const Things& things, Diagnostics& diagnostics);

// Checks of edits. `chosen`: by thing, 1 if the edit places or removes it.

using ThingPair = std::pair<std::uint32_t, std::uint32_t>;
/// Pairs with at least one chosen thing that may touch with the bodies at `bodies`: within 1 cm for robots.
std::vector<ThingPair> PairsOfChosen(const Things& things, std::span<const BodyState> bodies,
                                     std::span<const std::uint8_t> chosen);
/// Why the chosen things cannot stand there: "box BOX_1 would stand 0.1 m inside WALL_2: …". Empty if they
/// can.
std::string PlacementFault(const Scene& scene, const Things& things, std::span<const BodyState> bodies,
                           std::span<const std::uint8_t> chosen, std::span<const ThingPair> pairs);
/// The other dynamic things of `pairs`, increasing.
std::vector<std::uint32_t> NearChosen(const Things& things, std::span<const std::uint8_t> chosen,
                                      std::span<const ThingPair> pairs);

}  // namespace coopdyn
