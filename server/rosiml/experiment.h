// SPDX-License-Identifier: MIT
// The content of an experiment in either grammar, in SI units and world poses.
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
  Pose X_BG;  // pose in its body
  double mass_kg = 0;
  std::string colour;  // "r g b"; empty: the body's colour
  int line = 0;
  std::string mesh_file{};  // file of a Mesh whose data is still unread
};

struct Body {
  std::string name;
  Pose X_WB;
  std::vector<Part> parts;
  double mass_kg = 0;  // of all parts; 0: fixed to the world
  double friction = 0;
  double restitution = 0;
  std::optional<Vector3> centre_of_mass;  // overrides that of the parts
  std::string colour;
  int line = 0;
};

/// A body or part that sensors and joints refer to by name.
struct Named {
  std::string name;
  int body = 0;  // index into Movable::bodies
  Pose X_WN = {};
  int line = 0;
};

/// The drive train of a complex hinge. Values are on the joint's side unless they are of the motor shaft.
struct DriveTrain {
  struct Pwm {
    double duty = 1, no_load_speed_rad_s = 0, stall_torque_nm = 0, stall_current_a = 0;  // of the motor shaft
    int line = 0;
  };
  std::vector<Pwm> pwm;
  double ratio = 1, efficiency = 1;
  std::optional<double> rotor_inertia_kg_m2, stiffness_nm_rad;  // nullopt: default rotor; rigid coupling
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
  Pose X_WJ;                             // the joint's axis is x
  /// The position is that of the source relative to the destination, not vice versa.
  bool counts_source = true;
  bool is_driven = false;
  bool is_wheel = false;  // driven by velocity
  double max_effort = 0, max_velocity = 0;
  std::optional<std::pair<double, double>> limit;  // minimum and maximum position, rad or m
  double friction = 0, damping = 0, stiffness = 0, rest = 0;
  std::optional<DriveTrain> drive_train;  // includes all friction of the joint
  /// For kSixAxis only, starting at the source: hinges and sliders named x, y, z, rx, ry, rz, along the axes
  /// of X_WJ.
  std::vector<Joint> axes{};
  int line = 0;
};

/// A Hill-type muscle that pulls a point of one body towards a point of another.
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
  double most = 0;  // maximum, N or N m
  int line = 0;
};

struct Sensor {
  enum class Kind { kProximity, kLight, kAmbient, kCompass, kContact, kImu, kSharp, kCamera, kNeighbours };
  enum class Pattern { kCross, kFan, kCone };

  std::string name;
  Kind kind = Kind::kProximity;
  int body = 0;
  Pose X_WS;  // the sensor looks along x
  double range_m = 0;
  double opening_deg = 0;  // full horizontal angle of the cone or fan
  double opening_up_deg = 0;
  Pattern pattern = Pattern::kCross;  // proximity: rays in the middle and on the rim; side by side; full cone
  int rays = 1;
  double noise = 0;
  std::string colour;  // "r g b" of a light sensor; empty: sees all colours, without a limit
  std::string model;   // coopdyn's name of a Sharp sensor
  int width = 320, height = 240;
  int line = 0;
};

/// Maps a value inside the simulator to the value that clients exchange.
struct Mapped {
  std::optional<std::pair<double, double>> internal = {}, external = {};
  std::string noise = {};  // uniform or gaussian; empty: none
  double noise_mean = 0, noise_sigma = 0;
  std::string filter = {};  // sensors only: mean, median or low_pass; empty: none
  int filter_steps = 1;
  double filter_time_s = 0;
};

/// A value that a client sets.
struct MotorValue {
  std::string name;
  int joint = 0;          // index into Movable::joints; -1 for a muscle or a thruster
  std::string axis = {};  // for a joint with several axes
  std::string mode;       // velocity, direct, effort, pwm, limit
  Mapped mapped = {};
  int line = 0;
  int muscle = -1;    // index into Movable::muscles
  int thruster = -1;  // index into Movable::thrusters
};

/// Values of one source that a client reads. At most one index is set; none: a value of the world.
struct SensorValue {
  std::string name;
  int sensor = -1;        // index into Movable::sensors
  int joint = -1;         // index into Movable::joints
  std::string axis = {};  // for a joint with several axes
  int muscle = -1;        // index into Movable::muscles
  int body = -1;          // index into Movable::bodies; the place is X_WN
  Pose X_WN = {};
  std::vector<std::string> of = {};  // position, vx, …; empty for a sensor
  bool in_body = false;              // velocities along the body's own axes
  bool auxiliary = false;
  Mapped mapped = {};
  int line = 0;
};

/// The minimum and maximum of the values that each reset draws: x, y, z, gamma (degrees), mass, friction,
/// power or value.
struct Random {
  std::map<std::string, std::pair<double, double>> ranges;
  int line = 0;
};

/// A robot or object: bodies, with joints and muscles between them.
struct Movable {
  std::string name;
  Pose X_WM;  // the movable's own pose
  std::vector<Body> bodies;
  std::vector<Named> names;
  std::vector<Joint> joints;
  std::vector<Muscle> muscles;
  std::vector<Thruster> thrusters;
  std::vector<Sensor> sensors;
  std::vector<MotorValue> motors;   // values that a client sets, in exchange order
  std::vector<SensorValue> values;  // values that a client reads, in exchange order
  int exchange_steps = 1;
  int port = 0;             // TCP port that its client expects; 0 if unspecified
  std::vector<int> aborts;  // contact sensors that end a trial
  std::string controller;   // "NAME key=value …"; empty: clients drive the robot
  std::string colour;
  Random random;
  bool is_robot = false;
  bool is_sound = true;  // without errors in the file
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

/// A line of a section: key and value.
struct Setting {
  std::string text;
  int line = 0;
};

/// A score of the run.
struct Score {
  std::vector<std::string> of;    // names of movables and things; empty: all robots
  std::string target;             // name of a thing or a light
  std::vector<std::string> keys;  // the other lines of its section
  bool is_sound = true;
  int line = 0;
};

struct Experiment {
  std::vector<Setting> simulation, floor;  // lines of these sections
  std::optional<std::pair<double, double>> floor_size;
  Random ambient;  // ambient light: key "value"
  std::vector<Light> lights;
  std::vector<Movable> things, robots;
  std::vector<Score> scores;
};

}  // namespace coopdyn::rosiml
