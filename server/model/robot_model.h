// SPDX-License-Identifier: MIT
// The description of a robot type, read from SDF once per process. Immutable once read; thread-safe.
// Frame R is the model's frame: x forward, y left, z up, origin as given by the model; at rest z = 0 is the
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

/// A collision or visual shape of a link.
struct LinkShape {
  Shape shape;
  Pose X_LG;  // pose of the shape in the link
  Color color;
  double friction = 1;             // Coulomb; 0 for casters
  bool takes_robot_color = false;  // visuals: drawn in the robot's own colour
  double restitution = 0;          // fraction of the impact speed that remains: 0…1
  /// If not zero: the direction in G along which `friction` applies; `friction_across` applies across it.
  /// With a `friction_frame` (index into RobotModel::frames) the direction is in that frame and rotates with
  /// its link, like the rollers of a Mecanum wheel where they touch the floor.
  Vector3 friction_along_G = Vector3::Zero();
  int friction_frame = -1;
  double friction_across = 1;
  /// Torque against rolling (of round shapes) and against spinning about the normal, N m per N of load.
  double rolling_friction_m = 0, spinning_friction_m = 0;
  /// What it yields where it touches: a spring and a damper along the normal, N/m and N s/m. Infinite: hard.
  double contact_stiffness_n_m = std::numeric_limits<double>::infinity(), contact_damping_n_s_m = 0;
  /// Mesh collisions: maximum number of convex parts if the link moves.
  int most_parts = kMostConvexParts;
  /// Collisions: for all but the first part of a mesh with several parts, index of the first part; else -1.
  int piece_of = -1;
};

struct LinkModel {
  std::string name;
  Pose X_RL;  // in the initial pose
  double mass_kg = 0;
  Pose X_LI;              // inertial frame (centre of mass) in the link
  Vector3 inertia_kg_m2;  // principal moments about the axes of I
  std::vector<LinkShape> collisions;
  std::vector<LinkShape> visuals;
  bool is_carrier = false;  // between the axes of a joint: negligible mass, no shape
};

/// A link of the model's file. Fixed joints may have merged it into another link.
struct FrameModel {
  std::string name;
  int link = 0;  // index into links
  Pose X_RF;     // in the initial pose
};

/// A joint, or another element that clients drive like a joint. The child of a hinge (rad, N m) rotates about
/// the axis relative to the parent, that of a slider (m, N) moves along it. A screw rotates about its axis
/// (rad, N m) and moves along it by `pitch_m_rad`. Ball and universal joints rotate freely about a point and
/// cannot be driven. A muscle holds no links together: it pulls two links towards each other; its position is
/// its length (m, N). A force (m, N) and a torque (rad, N m) are thrusters: they push or turn their link,
/// which is both parent and child, along or about an axis fixed to it; the position is the link's travel
/// along that axis. A limiter drives nothing: its reference, in direct mode, is the maximum effort of another
/// joint's motor.
struct JointModel {
  enum class Kind { kHinge, kSlider, kBall, kUniversal, kScrew, kMuscle, kForce, kTorque, kLimiter };
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  std::string name;
  Kind kind = Kind::kHinge;
  int parent = 0;  // index into links
  int child = 0;
  Vector3 p_RJ = Vector3::Zero();  // a point on the axis, in the initial pose
  Vector3 axis_R = Vector3::UnitY();
  Vector3 axis2_R = Vector3::UnitX();            // second axis of a universal joint, fixed to the child
  double lower = -kInfinity, upper = kInfinity;  // stops
  double start = 0;                              // position in the initial pose
  double max_velocity = kInfinity, max_effort = kInfinity;
  double damping = 0;    // effort per velocity
  double friction = 0;   // Coulomb friction, as effort
  double stiffness = 0;  // of the spring: effort per displacement from `rest`
  double rest = 0;
  double armature = 0;            // inertia of the parts inside that move with it: kg m² (slider: kg)
  double pitch_m_rad = 0;         // screw: travel along the axis per radian
  double torque_per_force_m = 0;  // force: torque about its axis per force, as of a propeller
  std::optional<DriveTrainModel> drive_train = std::nullopt;  // of a hinge of a control board

  std::optional<MuscleModel> muscle = std::nullopt;  // only for kMuscle
  int limits = -1;                                   // limiter: index of the limited joint

  bool thrusts() const { return kind == Kind::kForce || kind == Kind::kTorque; }
  /// True if it holds two links together.
  bool joins() const { return kind < Kind::kMuscle; }
  bool slides() const { return kind == Kind::kSlider || kind == Kind::kMuscle || kind == Kind::kForce; }
  bool has_axis() const { return joins() && kind != Kind::kBall && kind != Kind::kUniversal; }
  /// True if a spring, a damper or friction acts on it.
  bool is_resisted() const { return damping > 0 || friction > 0 || stiffness > 0; }
  bool has_stop() const { return lower > -kInfinity || upper < kInfinity; }
};

/// hinge, slider, ball, universal, screw, muscle, force, torque or limiter.
const char* ToString(JointModel::Kind kind);

/// A gear, a belt or URDF's <mimic>: position of joints[follower] = multiplier · position of joints[leader] +
/// offset. No leader is a follower.
struct CouplingModel {
  int follower = 0;  // index into joints
  int leader = 0;
  double multiplier = 1;
  double offset = 0;  // rad or m
};

/// Two motorised wheels on one axle that crosses R's z axis. A positive wheel speed drives forward.
struct DriveModel {
  /// Front wheels that steer so that all axles meet in one point (Ackermann), according to the set-points of
  /// the motorised wheels.
  struct Steering {
    std::array<int, 2> joints{};   // left, right: index into RobotModel::joints; axes point up
    double wheelbase_m = 0;        // from the axle to the steering axes
    double half_track_m = 0;       // half the distance between the steering axes
    double max_curvature_1_m = 0;  // of the path of R's origin
  };

  double wheel_radius_m = 0;
  double track_m = 0;  // between the wheels' contact points
  double max_wheel_speed_rad_s = 0;
  double max_torque_nm = 0;
  std::optional<Steering> steering = std::nullopt;  // nullopt: differential drive
};

/// A control board: a group of joints that clients control individually. Each joint has finite maximum effort
/// and velocity.
struct BoardModel {
  enum class Profile { kMinimumJerk, kTrapezoidal };

  Profile profile = Profile::kMinimumJerk;  // of motions to a position
  bool gravity_compensation = false;        // motors carry the weight beyond them in every mode
  std::optional<FrameModel> tool;           // end of the chain; nullopt: the last link
  double encoder_resolution = 0;            // rad or m; 0: exact
  double encoder_noise_stddev = 0;
};

/// Muscles, commanded by activations.
struct MusclesModel {};

/// Thrusters, commanded by forces and torques.
struct ThrustersModel {};

/// Limiters of motors. Their module has no socket: the robot's channel sets them.
struct LimitersModel {};

/// How an actuator controls a joint. The values are those of the protocol. kKeep occurs only in commands: the
/// channel stays as it is.
enum class ControlMode : std::uint8_t {
  kIdle = 0,
  kPosition = 1,
  kDirect = 2,
  kVelocity = 3,
  kEffort = 4,
  kPwm = 5,  // duty of a drive train's motor, or activation of a muscle
  kKeep = 255
};
inline constexpr int kControlModes = 6;  // all but kKeep

/// The command of one channel, i.e. joint axis: rad, rad/s or N m; m, m/s or N for a sliding joint; a duty
/// from -1 to 1; an activation from 0 to 1.
struct Setpoint {
  double reference = 0;
  ControlMode mode = ControlMode::kVelocity;

  /// True if it commands motion or a force.
  bool drives() const {
    return reference != 0 &&
           (mode == ControlMode::kVelocity || mode == ControlMode::kEffort || mode == ControlMode::kPwm);
  }
  /// The set-point of a stop: without motion or force; a motion to a position ends where the joint is.
  Setpoint stopped() const {
    if (mode == ControlMode::kPosition) return {0, ControlMode::kVelocity};
    return {drives() ? 0 : reference, mode};
  }
  bool operator==(const Setpoint&) const = default;
};

/// Clamps a set-point to the limits of a control board's joint, a muscle or a thruster. Without a drive
/// train, a duty becomes idle.
Setpoint Limit(const JointModel& joint, Setpoint setpoint);

/// Drives joints on command. Its module has a slot in the command board.
struct ActuatorModel {
  std::string module;       // module name; empty: no module, and its joints stay at rest
  std::vector<int> joints;  // index into joints, one channel each; for a drive the left and the right wheel
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
  std::vector<std::shared_ptr<const MeshData>> meshes;  // owns the meshes of its shapes
  std::vector<LinkModel> links;                         // links[0] is the chassis, or the base of an arm
  bool fixed_base = false;                              // links[0] is fixed to the world
  bool has_loose = false;                               // some links are not connected to links[0] by joints
  std::vector<JointModel> joints;
  std::vector<CouplingModel> couplings;  // at most one per follower
  std::vector<FrameModel> frames;
  std::vector<ActuatorModel> actuators;
  std::vector<SensorModel> sensors;  // by kind, in the order of SensorKind; AddSensor() preserves the order
  Vector3 p_MR = Vector3::Zero();    // R's origin in the frame of the model's file
  double footprint_radius_m = 0;  // of the smallest vertical cylinder about R's z axis that holds the robot
  double height_m = 0;

  /// The names of the modules that drive the robot.
  std::vector<std::string> actuator_modules() const;
  bool has_actuators() const { return !actuator_modules().empty(); }
  /// True if it has no motors but a channel, whose client makes steps.
  bool is_only_observed() const { return actuators.empty() && Find<ChannelModel>() != nullptr; }
  /// Index of the actuator's first channel among the robot's channels.
  std::size_t FirstChannel(const ActuatorModel& actuator) const;
  bool has_boards() const;
  /// True if an actuator drives joints[joint].
  bool IsDriven(int joint) const;
  /// The coupling whose follower is joints[joint]; null if none.
  const CouplingModel* FindCoupling(int joint) const;
  /// Its two-wheel drive; null if it has none.
  const ActuatorModel* drive_actuator() const;
  const DriveModel* drive() const {
    const ActuatorModel* actuator = drive_actuator();
    return actuator == nullptr ? nullptr : &std::get<DriveModel>(actuator->kind);
  }
  /// True if it has joints other than the wheels of its drive, or loose links, or a base fixed to the world.
  bool has_limbs() const;
  /// All modules, in the order of their ports.
  std::vector<ModuleModel> modules() const;

  /// Adds a sensor after the others of its kind.
  void AddSensor(std::string name, SensorKind kind, const SensorTiming& timing = {});
  /// Sensor `number` (from 0) of a kind; null if there are fewer.
  template <typename Kind>
  const Kind* Find(std::size_t number = 0) const {
    for (const SensorModel& sensor : sensors) {
      const Kind* const kind = std::get_if<Kind>(&sensor.kind);
      if (kind != nullptr && number-- == 0) return kind;
    }
    return nullptr;
  }
  /// The number (from 0) of sensors[sensor] within its kind.
  std::size_t NumberOf(std::size_t sensor) const;
  /// The index into `sensors` of sensor `number` of a kind; sensors.size() if there are fewer.
  template <typename Kind>
  std::size_t IndexOf(std::size_t number = 0) const {
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      if (std::holds_alternative<Kind>(sensors[i].kind) && number-- == 0) return i;
    }
    return sensors.size();
  }
  /// Index of the first measured value of sensors[sensor] among the robot's (Frame::measured); for
  /// sensors.size() their total number.
  std::size_t FirstMeasured(std::size_t sensor) const;
  /// The sectors of all distance sensors, in order.
  std::vector<SectorModel> sectors() const;
  std::size_t sector_count() const;
  /// The longest delay with which the robot receives a broadcast.
  int message_delay_steps() const;
};

/// `robot` in the pose in which all its joints are at 0.
RobotModel AtZero(const RobotModel& robot);

}  // namespace coopdyn
