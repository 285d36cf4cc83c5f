// SPDX-License-Identifier: MIT
// All that collides in a scene: robots and objects, and what they are made of. Built once; only `frozen`
// changes. Only server/physics includes this file.
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

/// A rigid body, with its place when the mechanism stands at the origin.
struct RigidBody {
  double mass_kg = 0;
  Matrix3 inertia_kg_m2 = Matrix3::Identity();  // about its centre of mass, in its own axes
  Pose X_RB;
};

/// A joint between two bodies: those of the links that the model names.
struct Joint {
  const JointModel* model = nullptr;
  int channel = -1;                   // of the robot's channels, if a motor drives it
  int limiter = -1;                   // likewise: what sets its greatest effort
  double max_effort = 0;              // of its motor
  int steers = -1;                    // 0, 1: it turns the left or right front wheel of the robot's drive
  int control = -1;                   // of the robot's controls, if it belongs to a control board,
  const BoardModel* board = nullptr;  // this one
  std::vector<int> beyond;            // if its weight or inertia matters to the motor: the bodies it moves
};

/// What moves as a whole: the bodies, joints and shapes of a robot type in one fidelity, or of an object.
/// Constant once made and shared by all robots alike. A robot's body 0 is its chassis; of fidelity rolling
/// and planar it is all there is, with the axes of R and its origin in the common centre of mass. A static
/// object has no body; its only part stands in the world.
struct Mechanism {
  std::vector<RigidBody> bodies;
  std::vector<Joint> joints;
  std::vector<Part> parts;
  LimbTree tree;       // of `bodies`
  int joint_rows = 0;  // constraint rows of its joints and motors
  int floor_rows = 0;  // of its contacts when it stands

  // Robots only.
  const RobotModel* model = nullptr;
  Fidelity fidelity = Fidelity::kFull;
  int shell = -1;       // the upright cylinder among `parts` that covers all others in plan; -1: none
  double radius_m = 0;  // of the vertical cylinder about R's z axis that holds it when upright
  double reach_m = 0;   // of the sphere about R's origin that holds it however its links turn
  double height_m = 0;
  std::optional<OneBodyDrive> drive;  // fidelity rolling and planar, if it has wheels
  bool fixed_base = false;            // body 0 stands still in the world
  /// With joints other than wheels: of the sphere about each body's centre of mass that holds its parts.
  /// Its place in the world then follows from its bodies, not from the radius, reach and height above.
  std::vector<double> limb_radii_m;

  bool one_body() const { return model != nullptr && fidelity != Fidelity::kFull; }
  bool planar() const { return fidelity == Fidelity::kPlanar; }
  bool has_limbs() const { return !limb_radii_m.empty(); }
};

/// `model` on a floor with this friction. @pre masses and inertias are positive.
Mechanism MakeRobot(const RobotModel& model, Fidelity fidelity, double floor_friction, const Vector3& g_W);
Mechanism MakeObject(const WorldObject& object);

/// A robot or an object. Its own parts do not collide with each other.
struct Thing {
  // What each step looks at lies together.
  int robot = -1;   // index into Scene::robots; -1: an object
  int object = -1;  // index into Scene::objects; -1: a robot
  const Mechanism* mechanism = nullptr;
  std::size_t first_channel = 0, channel_count = 0;  // of Frame::channels; of objects none
  std::size_t first_control = 0, control_count = 0;  // of Frame::controls, likewise
  int first_body = 0;                                // of Frame::bodies; static: none
  bool frozen = false;                               // held in place: nothing is joined to its bodies
  std::size_t pool = 0;                              // of Things::pools: what kind of bodies it needs in ODE

  // Robots only.
  double rest_z_m = 0;              // of one body: height of its centre of mass at rest
  Vector3 p_BR = Vector3::Zero();   // R's origin in the first body
  Vector3 up_B = Vector3::UnitZ();  // R's z axis in the first body

  BodyState fixed{};  // of a static object: where it stands

  std::size_t body_count() const { return mechanism->bodies.size(); }
};

/// A thing and where it is.
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
  std::vector<std::shared_ptr<const Mechanism>> mechanisms;  // Rebuild() takes them over
  std::vector<Thing> all;  // dynamic objects, then robots from `first_robot` on, then static objects
  std::size_t first_robot = 0;
  std::size_t first_static = 0;
  /// What ODE is asked to move: single bodies (null), and each mechanism of several.
  std::vector<const Mechanism*> pools{nullptr};
  std::vector<BodyState> bodies;  // of Frame::bodies: where everything begins

  Actor ActorOf(std::size_t thing, std::span<const BodyState> bodies) const {
    const Thing& info = all[thing];
    if (thing >= first_static) return {info, &info.fixed};
    return {info, bodies.data() + info.first_body};
  }
};

/// The things of `scene`, which outlives them. @pre all masses and inertias are positive.
Things MakeThings(const Scene& scene);
/// The same for a scene with the floor and gravity of before: robots of a kind that was there before share
/// its mechanism, and `bodies` is empty.
Things MakeThings(const Scene& scene, const Things& before);

/// Turns a body to `q`.
void Orient(BodyState& body, const Quaternion& q);

/// Where the bodies of a thing begin, at rest, if its model's frame is at `X_WR`.
std::vector<BodyState> StartBodies(const Mechanism& mechanism, const Pose& X_WR);
/// The same of an object, in the motion with which it begins.
std::vector<BodyState> StartBodies(const Mechanism& mechanism, const WorldObject& object);

/// What a thing is called: `robot robot1`, `box BOX_1`; its name alone; and where the files say so.
std::string TitleOf(const Scene& scene, const Thing& thing);
const std::string& NameOf(const Scene& scene, const Thing& thing);
const SourceLine& WhereOf(const Scene& scene, const Thing& thing);

// What must be right before the first step.

/// Reports robots whose model cannot be simulated (a link without mass). Call before MakeThings().
void CheckModels(const Scene& scene, Diagnostics& diagnostics);
/// Reports every dynamic thing that starts more than 1 mm inside another or below the floor, and by how much:
/// an error; where the scenario says `overlaps yes` it is mended, or a warning if its middle lies in what is
/// fixed.
void CheckStart(const Scene& scene, const Things& things, Diagnostics& diagnostics);

// What an edit looks at. `chosen`: by thing, 1: it is one of those that the edit puts there, or takes away.

using ThingPair = std::pair<std::uint32_t, std::uint32_t>;
/// Pairs of which at least one is chosen, and that may touch where `bodies` say: within 1 cm for robots.
std::vector<ThingPair> PairsOfChosen(const Things& things, std::span<const BodyState> bodies,
                                     std::span<const std::uint8_t> chosen);
/// Why the chosen cannot stand there: "box BOX_1 would stand 0.1 m inside WALL_2: …"; empty: they can.
std::string WhyNotThere(const Scene& scene, const Things& things, std::span<const BodyState> bodies,
                        std::span<const std::uint8_t> chosen, std::span<const ThingPair> pairs);
/// The other dynamic things of `pairs`, increasing.
std::vector<std::uint32_t> NearChosen(const Things& things, std::span<const std::uint8_t> chosen,
                                      std::span<const ThingPair> pairs);

}  // namespace coopdyn
