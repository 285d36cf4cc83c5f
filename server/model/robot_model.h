// SPDX-License-Identifier: MIT
// The fixed description of a robot type, read from SDF once per process. Constant once read; any thread.
// Frame R is the model's: x forward, y left, z up, its origin where the model says; at rest z = 0 is the
// floor.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/geometry/convex_parts.h"
#include "server/geometry/shape.h"
#include "server/model/drive_train.h"
#include "server/model/muscle.h"
#include "server/model/sensor_models.h"
#include "server/model/world_model.h"

namespace coopdyn {

/// A shape that belongs to a link.
struct LinkShape {
  Shape shape;
  Pose X_LG;  // of the shape in the link
  Color color;
  double friction = 1;             // Coulomb; 0 for casters
  bool takes_robot_color = false;  // visuals: drawn in the robot's own colour
  double restitution = 0;          // of the speed of an impact that stays: 0…1
  /// If not zero: the direction, in G, in which `friction` counts; across it the other one does. With a
  /// `friction_frame`, an index into RobotModel::frames, it is one of that link, and turns with it: the
  /// rollers of a Mecanum wheel stand so where they touch the floor.
  Vector3 friction_along_G = Vector3::Zero();
  int friction_frame = -1;
  double friction_across = 1;
  /// Torque against rolling (where it is round) and against spinning about the normal, N m per N of load.
  double rolling_friction_m = 0, spinning_friction_m = 0;
  /// Collisions that are meshes: as how many convex parts it collides at most if it moves.
  int most_parts = kMostConvexParts;
  /// Collisions: of a mesh that collides as several parts, all but the first: index of the first.
  int piece_of = -1;
};

struct LinkModel {
  std::string name;
  Pose X_RL;  // in the initial pose
  double mass_kg = 0;
  Pose X_LI;              // of the inertial frame (centre of mass) in the link
  Vector3 inertia_kg_m2;  // principal moments about the axes of I
  std::vector<LinkShape> collisions;
  std::vector<LinkShape> visuals;
  bool is_carrier = false;  // between the axes of one joint: next to no mass, no shape
};

/// A link of the model's file. Fixed joints may have made it a part of another.
struct FrameModel {
  std::string name;
  int link = 0;  // index into links
  Pose X_RF;     // in the initial pose
};

/// An axis about which (hinge: rad, N m), or along which (slider: m, N), the child moves against its parent.
/// A screw turns about its axis (rad, N m) and moves along it by `pitch_m_rad`. Ball and universal joints
/// turn freely about a point; nothing drives them. A muscle joins nothing: it pulls two links together, and
/// its position is its length (m, N). A force (m, N) and a torque (rad, N m) are thrusters: they push or turn
/// their link, parent and child, along or about an axis that it carries; the position is its way along that.
/// A limiter drives nothing: its reference, in direct mode, is the greatest effort of another joint's motor.
struct JointModel {
  enum class Kind { kHinge, kSlider, kBall, kUniversal, kScrew, kMuscle, kForce, kTorque, kLimiter };
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  std::string name;
  Kind kind = Kind::kHinge;
  int parent = 0;  // index into links
  int child = 0;
  Vector3 p_RJ = Vector3::Zero();  // a point of the axis, in the initial pose
  Vector3 axis_R = Vector3::UnitY();
  Vector3 axis2_R = Vector3::UnitX();            // of a universal joint, on the child
  double lower = -kInfinity, upper = kInfinity;  // its stops
  double start = 0;                              // its position in the initial pose
  double max_velocity = kInfinity, max_effort = kInfinity;
  double damping = 0;    // effort per velocity
  double friction = 0;   // Coulomb: effort
  double stiffness = 0;  // of a spring: effort per way from `rest`
  double rest = 0;
  double armature = 0;            // of what turns or slides with it inside: kg m² (a slider's: kg)
  double pitch_m_rad = 0;         // of a screw: way along the axis per radian
  double torque_per_force_m = 0;  // of a force: about its axis, as a propeller has
  std::optional<DriveTrainModel> drive_train = std::nullopt;  // of a hinge of a control board

  std::optional<MuscleModel> muscle = std::nullopt;  // if it is one
  int limits = -1;                                   // of a limiter: index into the joints

  bool thrusts() const { return kind == Kind::kForce || kind == Kind::kTorque; }
  /// It holds two links together.
  bool joins() const { return kind < Kind::kMuscle; }
  bool slides() const { return kind == Kind::kSlider || kind == Kind::kMuscle || kind == Kind::kForce; }
  bool has_axis() const { return joins() && kind != Kind::kBall && kind != Kind::kUniversal; }
  /// A spring, a damper or friction works on it.
  bool is_resisted() const { return damping > 0 || friction > 0 || stiffness > 0; }
  bool has_stop() const { return lower > -kInfinity || upper < kInfinity; }
};

/// hinge, slider, ball, universal, screw, muscle, force, torque or limiter.
const char* ToString(JointModel::Kind kind);

/// Gears, belts and URDF's <mimic>: the position of joints[follower] is multiplier · that of joints[leader] +
/// offset. No leader is a follower.
struct CouplingModel {
  int follower = 0;  // index into joints
  int leader = 0;
  double multiplier = 1;
  double offset = 0;  // rad or m
};

/// Two motorised wheels on one axle, which crosses R's z axis. A positive speed of a wheel drives forward.
struct DriveModel {
  /// Front wheels that turn about the vertical so that all axles meet in one point (Ackermann): by the speeds
  /// that the motorised wheels are to have.
  struct Steering {
    std::array<int, 2> joints{};   // left, right: index into RobotModel::joints; their axes point up
    double wheelbase_m = 0;        // from the axle to their axes
    double half_track_m = 0;       // between their axes
    double max_curvature_1_m = 0;  // of the path of R's origin
  };

  double wheel_radius_m = 0;
  double track_m = 0;  // between the wheels' contact points
  double max_wheel_speed_rad_s = 0;
  double max_torque_nm = 0;
  std::optional<Steering> steering = std::nullopt;  // none: it turns by its wheels' speeds alone
};

/// A group of joints that clients control one by one: a control board. Each of its joints has a finite
/// effort and velocity.
struct BoardModel {
  enum class Profile { kMinimumJerk, kTrapezoidal };

  Profile profile = Profile::kMinimumJerk;  // of the way to a position
  bool gravity_compensation = false;        // its motors carry the weight beyond them in every mode
  std::optional<FrameModel> tool;           // where its chain ends; empty: at the last link
  double encoder_resolution = 0;            // rad or m; 0: exact
  double encoder_noise_stddev = 0;
};

/// Muscles, by their activations.
struct MusclesModel {};

/// Thrusters, by their forces and torques.
struct ThrustersModel {};

/// Limiters of motors. Their module has no socket: the robot's channel sets them.
struct LimitersModel {};

/// What an actuator does with a joint; the numbers are those of the wire. kKeep stands in commands alone: the
/// channel goes on as it does.
enum class ControlMode : std::uint8_t {
  kIdle = 0,
  kPosition = 1,
  kDirect = 2,
  kVelocity = 3,
  kEffort = 4,
  kPwm = 5,  // the duty of the motor of a drive train, the activation of a muscle
  kKeep = 255
};
inline constexpr int kControlModes = 6;  // that can be in force

/// What is wanted of one channel: a joint axis. rad, rad/s or N m; of a sliding joint m, m/s or N; a duty
/// from -1 to 1, an activation from 0 to 1.
struct Setpoint {
  double reference = 0;
  ControlMode mode = ControlMode::kVelocity;

  /// Whether it asks for motion, or a force.
  bool drives() const {
    return reference != 0 &&
           (mode == ControlMode::kVelocity || mode == ControlMode::kEffort || mode == ControlMode::kPwm);
  }
  /// The same at rest: nothing drives, a motion to a position ends here.
  Setpoint stopped() const {
    if (mode == ControlMode::kPosition) return {0, ControlMode::kVelocity};
    return {drives() ? 0 : reference, mode};
  }
  bool operator==(const Setpoint&) const = default;
};

/// Within the limits of a joint of a control board, a muscle or a thruster. Without a drive train a duty is
/// idle.
Setpoint Limit(const JointModel& joint, Setpoint setpoint);

/// What moves joints on command. Its module is a slot of the command board.
struct ActuatorModel {
  std::string module;       // its module's name; empty: it has none, and its joints are at rest
  std::vector<int> joints;  // index into joints: one channel each; of a drive the left and the right wheel
  std::variant<DriveModel, BoardModel, MusclesModel, ThrustersModel, LimitersModel> kind;

  bool is_board() const { return std::holds_alternative<BoardModel>(kind); }
  bool is_drive() const { return std::holds_alternative<DriveModel>(kind); }
  bool is_muscles() const { return std::holds_alternative<MusclesModel>(kind); }
  bool is_thrusters() const { return std::holds_alternative<ThrustersModel>(kind); }
  bool is_limiters() const { return std::holds_alternative<LimitersModel>(kind); }
  /// The word for such a module in a robot's SDF.
  const char* type() const;
};

/// A hardware module: its socket is /ROBOT/name.
struct ModuleModel {
  std::string type;  // motors, distance, …
  std::string name;
};

struct RobotModel {
  std::string type;  // the folder's name, e.g. "coopbot"
  std::string file;
  std::string text;                                     // the SDF as read
  std::vector<std::shared_ptr<const MeshData>> meshes;  // those that its shapes name
  std::vector<LinkModel> links;                         // links[0] is the chassis, the base of an arm
  bool fixed_base = false;                              // links[0] is fixed to the world
  bool has_loose = false;                               // some links hang on no joint that leads to links[0]
  std::vector<JointModel> joints;
  std::vector<CouplingModel> couplings;  // at most one of each follower
  std::vector<FrameModel> frames;
  std::vector<ActuatorModel> actuators;
  std::vector<SensorModel> sensors;  // kind by kind, in the order of SensorKind; AddSensor() keeps it
  Vector3 p_MR = Vector3::Zero();    // R's origin in the frame of the model's file
  double footprint_radius_m = 0;     // of the smallest vertical cylinder about R's z axis that holds it
  double height_m = 0;

  /// The names of the modules that drive the robot.
  std::vector<std::string> actuator_modules() const;
  bool has_actuators() const { return !actuator_modules().empty(); }
  /// It has no motors, but a channel, whose client makes steps.
  bool is_only_observed() const { return actuators.empty() && Find<ChannelModel>() != nullptr; }
  /// Where the channels of one of its actuators begin among those of the robot.
  std::size_t FirstChannel(const ActuatorModel& actuator) const;
  bool has_boards() const;
  /// An actuator has joints[joint].
  bool IsDriven(int joint) const;
  /// What joints[joint] follows; null if nothing.
  const CouplingModel* FindCoupling(int joint) const;
  /// Its two-wheel drive; null if it has none.
  const ActuatorModel* drive_actuator() const;
  const DriveModel* drive() const {
    const ActuatorModel* actuator = drive_actuator();
    return actuator == nullptr ? nullptr : &std::get<DriveModel>(actuator->kind);
  }
  /// It has joints other than the wheels of its drive, links that hang on none, or is fixed to the world.
  bool has_limbs() const;
  /// All modules, in the order of their ports.
  std::vector<ModuleModel> modules() const;

  /// Adds a sensor after the others of its kind.
  void AddSensor(std::string name, SensorKind kind, const SensorTiming& timing = {});
  /// Sensor `number` of a kind, counted from 0; null if there are fewer.
  template <typename Kind>
  const Kind* Find(std::size_t number = 0) const {
    for (const SensorModel& sensor : sensors) {
      const Kind* const kind = std::get_if<Kind>(&sensor.kind);
      if (kind != nullptr && number-- == 0) return kind;
    }
    return nullptr;
  }
  /// Which of its kind sensors[sensor] is, counted from 0.
  std::size_t NumberOf(std::size_t sensor) const;
  /// The index into `sensors` of sensor `number` of a kind; sensors.size() if there are fewer.
  template <typename Kind>
  std::size_t IndexOf(std::size_t number = 0) const {
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      if (std::holds_alternative<Kind>(sensors[i].kind) && number-- == 0) return i;
    }
    return sensors.size();
  }
  /// Where the measured values of sensors[sensor] begin among those of the robot (Frame::measured); of
  /// sensors.size(): how many these are.
  std::size_t FirstMeasured(std::size_t sensor) const;
  /// The sectors of all distance sensors, in their order; and how many these are.
  std::vector<SectorModel> sectors() const;
  std::size_t sector_count() const;
  /// The longest delay of a broadcast that the robot hears.
  int message_delay_steps() const;
};

/// `robot` in the pose in which all its joints stand at 0.
RobotModel AtZero(const RobotModel& robot);

}  // namespace coopdyn
