// SPDX-License-Identifier: MIT
// What an experiment says, whatever its grammar: SI units, poses in the world.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/geometry/shape.h"

namespace coopdyn::rosiml {

/// A shape of a rigid body.
struct Part {
  Shape shape = Sphere{};
  Pose X_BG;  // in its body
  double mass_kg = 0;
  std::string colour;  // "r g b"; empty: its body's
  int line = 0;
  std::string mesh_file{};  // of a Mesh, whose data nobody has read yet
};

struct Body {
  std::string name;
  Pose X_WB;
  std::vector<Part> parts;
  double mass_kg = 0;  // of all its parts; 0: it stands fixed
  double friction = 0;
  double restitution = 0;
  std::optional<Vector3> centre_of_mass;  // instead of that of its parts
  std::string colour;
  int line = 0;
};

/// What sensors and joints name: a body, or a part of it.
struct Named {
  std::string name;
  int body = 0;  // index into Movable::bodies
  Pose X_WN = {};
  int line = 0;
};

/// What drives a complex hinge; on the joint's side, but for what is said of the motor's shaft.
struct DriveTrain {
  struct Pwm {
    double duty = 1, no_load_speed_rad_s = 0, stall_torque_nm = 0, stall_current_a = 0;  // of the shaft
    int line = 0;
  };
  std::vector<Pwm> pwm;
  double ratio = 1, efficiency = 1;
  std::optional<double> rotor_inertia_kg_m2, stiffness_nm_rad;  // none: the usual rotor; a rigid coupling
  double backlash_deg = 0, damping_nms_rad = 0, preload_nm = 0;
  double static_friction_nm = 0, dynamic_friction_nm = 0;
  std::optional<double> stiction_speed_rad_s;
  int line = 0;
};

struct Joint {
  enum class Kind { kHinge, kSlider, kBall, kFixed, kSixAxis };
  static constexpr int kWorld = -1;

  std::string name;
  Kind kind = Kind::kHinge;
  int source = 0, destination = kWorld;  // index into Movable::bodies
  Pose X_WJ;                             // its axis is x
  /// Its position counts how the source moves against the destination, not the other way round.
  bool counts_source = true;
  bool is_driven = false;
  bool is_wheel = false;  // driven by velocity
  double max_effort = 0, max_velocity = 0;
  std::optional<std::pair<double, double>> limit;  // least and most position, rad or m
  double friction = 0, damping = 0, stiffness = 0, rest = 0;
  std::optional<DriveTrain> drive_train;  // then it has no friction besides
  /// Of a kSixAxis, from the source on: hinges and sliders called x, y, z, rx, ry, rz, along the axes of
  /// X_WJ.
  std::vector<Joint> axes{};
  int line = 0;
};

/// Hill's: pulls a point of one body towards a point of another.
struct Muscle {
  std::string name;
  int source = 0, destination = 0;  // index into Movable::bodies
  Vector3 p_W_source, p_W_destination;
  double max_force_n = 0;
  double optimal_length_m = 0, width = 0, c = 0;
  double max_velocity_m_s = 0, eccentric = 0, curvature = 0;
  bool use_length = true, use_velocity = true;
  int line = 0;
};

/// A force or a torque on a body, along or about one of its axes.
struct Thruster {
  std::string name;
  int body = 0;  // index into Movable::bodies
  int axis = 0;  // 0 x, 1 y, 2 z
  bool turns = false;
  double most = 0;  // N, N m
  int line = 0;
};

struct Sensor {
  enum class Kind { kProximity, kLight, kAmbient, kCompass, kContact, kImu, kSharp, kCamera, kNeighbours };
  enum class Pattern { kCross, kFan, kCone };

  std::string name;
  Kind kind = Kind::kProximity;
  int body = 0;
  Pose X_WS;  // it looks along x
  double range_m = 0;
  double opening_deg = 0;  // of the whole cone or fan; across
  double opening_up_deg = 0;
  Pattern pattern = Pattern::kCross;  // of a proximity sensor: the middle and the rim, side by side, all
  int rays = 1;
  double noise = 0;
  std::string colour;  // "r g b", of a light sensor; empty: it sees all and has no limit
  std::string model;   // of a Sharp, as coopdyn calls it
  int width = 320, height = 240;
  int line = 0;
};

/// From a value inside the simulator to the one that clients exchange.
struct Mapped {
  std::optional<std::pair<double, double>> internal = {}, external = {};
  std::string noise = {};  // uniform or gaussian; empty: none
  double noise_mean = 0, noise_sigma = 0;
  std::string filter = {};  // of a sensor's value: mean, median or low_pass; empty: none
  int filter_steps = 1;
  double filter_time_s = 0;
};

/// A value that a client sets.
struct MotorValue {
  std::string name;
  int joint = 0;          // index into Movable::joints; -1: it is a muscle or a thruster
  std::string axis = {};  // of a joint that has several
  std::string mode;       // velocity, direct, effort, pwm, limit
  Mapped mapped = {};
  int line = 0;
  int muscle = -1;    // index into Movable::muscles
  int thruster = -1;  // index into Movable::thrusters
};

/// Values that a client gets, of one sensor.
struct SensorValue {
  std::string name;
  int sensor = -1;        // index into Movable::sensors, or
  int joint = -1;         // into Movable::joints, or
  std::string axis = {};  // of a joint that has several
  int muscle = -1;        // into Movable::muscles, or
  int body = -1;          // into Movable::bodies, at X_WN; none of them: of the world
  Pose X_WN = {};
  std::vector<std::string> of = {};  // position, vx, …; of a sensor nothing
  bool in_body = false;              // velocities along its own axes
  bool auxiliary = false;
  Mapped mapped = {};
  int line = 0;
};

/// What each reset draws: x, y, z, gamma (degrees), mass, friction, power or value, from the least to the
/// most.
struct Random {
  std::map<std::string, std::pair<double, double>> ranges;
  int line = 0;
};

/// A robot, or what stands or lies about: bodies and what joins them.
struct Movable {
  std::string name;
  Pose X_WM;  // its own pose
  std::vector<Body> bodies;
  std::vector<Named> names;
  std::vector<Joint> joints;
  std::vector<Muscle> muscles;
  std::vector<Thruster> thrusters;
  std::vector<Sensor> sensors;
  std::vector<MotorValue> motors;   // what a client exchanges, in this order
  std::vector<SensorValue> values;  // likewise
  int exchange_steps = 1;
  int port = 0;             // where its client looks for it; 0: it does not say
  std::vector<int> aborts;  // contact sensors that end a try
  std::string controller;   // "NAME key=value …"; empty: clients drive it
  std::string colour;
  Random random;
  bool is_robot = false;
  bool is_sound = true;  // without mistakes
  int line = 0;
};

struct Light {
  Vector3 p_W = Vector3::Zero();
  std::string colour;
  double power = 1;
  bool shadows = true;
  Random random;
  int line = 0;
  std::string name;
  bool is_sound = true;
};

/// A line of a section: its key with its value.
struct Setting {
  std::string text;
  int line = 0;
};

/// What a run is worth.
struct Score {
  std::vector<std::string> of;    // names of movables and things; none: all robots
  std::string target;             // of a thing or a light
  std::vector<std::string> keys;  // the other lines of its section
  bool is_sound = true;
  int line = 0;
};

struct Experiment {
  std::vector<Setting> simulation, floor;  // lines of these sections
  std::optional<std::pair<double, double>> floor_size;
  Random ambient;  // its value
  std::vector<Light> lights;
  std::vector<Movable> things, robots;
  std::vector<Score> scores;
};

}  // namespace coopdyn::rosiml
