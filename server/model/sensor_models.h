// SPDX-License-Identifier: MIT
// Descriptions of the sensors of a robot type. Immutable once read; thread-safe. SI units. L is a link's
// frame, S a sensor's: x forward, y left, z up. sensors/KIND.cc reads and describes one.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/geometry/shape.h"
#include "server/model/channel_model.h"

namespace coopdyn {

/// The error of a reading, in the reading's unit.
struct ValueNoise {
  double stddev = 0;     // Gaussian, drawn for each sample
  double bias_mean = 0;  // of a Gaussian bias, drawn once per run
  double bias_stddev = 0;
  double resolution = 0;  // readings are rounded to multiples of it; 0: not rounded
  double uniform = 0;     // half width of uniform noise, drawn for each sample

  bool exact() const {
    return stddev <= 0 && uniform <= 0 && bias_mean == 0 && bias_stddev <= 0 && resolution <= 0;
  }
  bool operator==(const ValueNoise&) const = default;
};

/// The sampling rate and delay of a sensor.
struct SensorTiming {
  double rate_hz = 0;  // 0: in each step. Sample k is taken in the first step at or after k / rate_hz
  double delay_s = 0;  // the reading is the newest sample of at least this age

  bool each_step() const { return rate_hz <= 0 && delay_s <= 0; }
  bool operator==(const SensorTiming&) const = default;
};

/// The names of a reading's values: `before`1`after`, `before`2`after`, …
struct NumberedNames {
  const char* before;
  const char* after;
  std::size_t count;
};

// The kinds of sensors. kType is the type of the module in a robot's SDF, kElement the element that describes
// it. A kind may also have
// - void Read(const SensorSource& source): reads its element
// - std::string Text(const RobotModel& robot) const: describes it, e.g. "360 rays, 0.12 to 3.5 m"
// - static constexpr std::array kValues: the names of its reading's values, with units. Or
//   NumberedNames values() const, if they mean the same; or std::vector<std::string> ValueNames() const.
//   Without names, the length of its reading varies
// - std::size_t measured() const: the number of values that physics measures in each step.

/// One range of a `distance` module: the smallest of several rays across a sector in the horizontal plane of
/// its mount.
struct SectorModel {
  Pose X_RS;               // x along the sector's middle; its origin lies on the chassis surface
  double bearing_rad = 0;  // of the middle in R; 0 ahead, left positive
  double opening_rad = 0;  // full angle of the sector
  int rays = 1;            // evenly spaced from edge to edge; 1: in the middle
  double max_range_m = 0;  // from the chassis surface
  double noise_stddev_m = 0;
};
struct DistanceModel {
  static constexpr const char* kType = "distance";
  static constexpr SensorElement kElement{"coopdyn:distance_sensors", "<coopdyn:distance_sensors>", false};
  std::vector<SectorModel> sectors;  // by increasing bearing (right to left)

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  NumberedNames values() const { return {"range", "_m", sectors.size()}; }
};

/// Vision: targets and other robots by distance and bearing.
struct TargetModel {
  static constexpr const char* kType = "target";
  static constexpr SensorElement kElement{"coopdyn:target_sensor", "", false};
  double max_range_m = std::numeric_limits<double>::infinity();
  bool see_through = true;  // obstacles do not hide targets
  double distance_noise_stddev_m = 0;
  double bearing_noise_stddev_rad = 0;

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
};

/// Ground truth.
struct PoseModel {
  static constexpr const char* kType = "pose";
  static constexpr SensorElement kElement{};
  static constexpr std::array kValues{"x_m", "y_m", "heading_rad", "forward_m_s", "turn_rad_s"};
  int link = 0;  // the link that carries the reported frame R
};

/// Range and bearing to robots nearby, and short broadcasts to them.
struct NeighboursModel {
  static constexpr const char* kType = "neighbours";
  static constexpr SensorElement kElement{"coopdyn:neighbours", "<coopdyn:neighbours range=\"1\"/>", false};
  double range_m = 0;                        // of sight, between the robots' centres, in the plane
  double message_range_m = 0;                // of broadcasts; 0: receives none
  double loss = 0;                           // probability that a receiver loses a message, 0…1
  int delay_steps = 0;                       // extra delay beyond the one step of every message
  static constexpr int kMaxDelaySteps = 99;  // frames keep the broadcasts of 100 steps
  double distance_noise_stddev_m = 0;
  double bearing_noise_stddev_rad = 0;

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
};

/// The heading of R in the world.
struct CompassModel {
  static constexpr const char* kType = "compass";
  static constexpr SensorElement kElement{"coopdyn:compass", "", false};
  static constexpr std::array kValues{"heading_rad"};
  double noise_stddev_rad = 0;

  void Read(const SensorSource& source);
};

/// The displacement, caused by a load, of the support that carries it: a link on passive joints.
struct SupportModel {
  static constexpr const char* kType = "support";
  static constexpr SensorElement kElement{"coopdyn:support",
                                          "<coopdyn:support link=\"cradle\" height=\"0.3\"/>", false};
  static constexpr std::array kValues{"x_m", "y_m", "angle_rad"};
  std::string link;
  double height_m = 0;  // in R, where the load rests
  double noise_stddev_m = 0;
  double angle_noise_stddev_rad = 0;

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
};

/// Acceleration, angular velocity and orientation of the sensor. At rest and level, it reads +g upwards.
struct ImuModel {
  static constexpr const char* kType = "imu";
  static constexpr SensorElement kElement{"coopdyn:imu"};
  static constexpr std::array kValues{"qw",       "qx",       "qy",      "qz",      "wx_rad_s",
                                      "wy_rad_s", "wz_rad_s", "ax_m_s2", "ay_m_s2", "az_m_s2"};
  Mount mount;
  std::array<ValueNoise, 3> turn_noise;          // about x, y, z: rad/s
  std::array<ValueNoise, 3> acceleration_noise;  // along x, y, z: m/s²
  double orientation_noise_stddev_rad = 0;       // about each axis

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  /// Acceleration of the sensor's origin without gravity, in S.
  static constexpr std::size_t measured() { return 3; }
};

/// Force and torque through a joint, from everything beyond it. The joint is not part of a closed loop.
struct WrenchModel {
  static constexpr const char* kType = "wrench";
  static constexpr SensorElement kElement{"coopdyn:wrench", "<coopdyn:wrench joint=\"wrist\"/>"};
  static constexpr std::array kValues{"fx_n", "fy_n", "fz_n", "tx_nm", "ty_nm", "tz_nm"};
  /// All or a part of a link: the file's links beyond the sensor's joint that fixed joints have welded to it.
  struct Part {
    int link = 0;
    double mass_kg = 0;
    Pose X_LI;  // centre of mass and principal axes of the part
    Vector3 inertia_kg_m2 = Vector3::Zero();
    std::vector<std::size_t> collisions;  // index into LinkModel::collisions
  };

  std::string joint;  // name in the file
  Mount mount;        // the measuring frame; its origin is the joint's
  /// false: the wrench of the parent on the child, at rest +weight upwards; true: the opposite.
  bool on_parent = false;
  Part part;                // the child
  std::vector<int> beyond;  // links that hang on the child by moving joints
  std::array<ValueNoise, 3> force_noise, torque_noise;

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  /// Force and torque in S.
  static constexpr std::size_t measured() { return 6; }
};

/// Ranges along rays from one point, row by row from the lowest, each row from right to left.
struct LidarModel {
  static constexpr const char* kType = "lidar";
  static constexpr SensorElement kElement{"coopdyn:lidar", "<coopdyn:lidar max_range=\"4\"/>"};
  Mount mount;
  int columns = 1, rows = 1;
  double first_azimuth_rad = 0, last_azimuth_rad = 0;      // of the first and the last column
  double first_elevation_rad = 0, last_elevation_rad = 0;  // of the lowest and the highest row
  double min_range_m = 0, max_range_m = 0;                 // nearer reads 0, further reads inf
  ValueNoise noise;

  std::size_t rays() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  /// What must hold for every element: what to write instead; empty if valid.
  std::string Wrong() const;
  NumberedNames values() const { return {"range", "_m", rays()}; }
};

/// Contacts of some of the robot's shapes.
struct ContactModel {
  static constexpr const char* kType = "contact";
  static constexpr SensorElement kElement{"coopdyn:contact", "<coopdyn:contact/>"};
  struct Part {
    int link = 0;
    std::size_t collision = 0;  // index into LinkModel::collisions
  };
  /// A zone of a bumper, pressed by contacts whose bearing about R's z axis lies within it.
  struct Zone {
    double bearing_rad = 0, opening_rad = 0;  // middle and full angle
  };
  std::vector<Part> parts;
  std::vector<Zone> zones;  // right to left; empty: one zone all round
  double threshold_n = 0;   // a zone is pressed above this force

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  NumberedNames values() const { return {"pressed", "", zones.empty() ? 1 : zones.size()}; }
};

/// Ultrasound: the range of the nearest thing within a cone, or along a few rays in it.
struct SonarModel {
  static constexpr const char* kType = "sonar";
  static constexpr SensorElement kElement{"coopdyn:sonar", "<coopdyn:sonar>"};
  struct Beam {
    Mount mount;             // along x
    double opening_rad = 0;  // full angle of the cone
    double min_range_m = 0, max_range_m = 0;
    /// 0: the whole cone. Else one ray in the middle and rays - 1 around the rim, from the left upwards.
    int rays = 0;
    double opening_up_rad = 0;  // with rays: full vertical angle; `opening_rad` is the horizontal one
    ValueNoise noise = {};

    /// The direction of ray `index` in S.
    Vector3 Direction(int index) const;
  };
  std::vector<Beam> beams;

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  NumberedNames values() const { return {"range", "_m", beams.size()}; }
};

/// Infrared range finders, with a table of their output over distance.
struct InfraredModel {
  static constexpr const char* kType = "infrared";
  static constexpr SensorElement kElement{"coopdyn:infrared", "<coopdyn:infrared preset=\"gp2d12\">"};
  struct Row {
    double distance_m = 0, value = 0, noise_stddev = 0;
  };
  std::vector<Mount> eyes;  // along x
  std::vector<Row> curve;   // by increasing distance, at least two rows; linear between, constant beyond
  double opening_rad = 0;   // full angle; the nearest of `rays` in its plane counts
  int rays = 1;
  double max_range_m = 0;  // reads `dark` if nothing is nearer
  double dark = 0;
  ValueNoise noise;  // in addition to that of the curve

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  NumberedNames values() const { return {"value", "", eyes.size()}; }
};

/// Light-dependent resistors, and sensors of ambient light.
struct LightModel {
  static constexpr const char* kType = "light";
  static constexpr SensorElement kElement{"coopdyn:light", "<coopdyn:light>"};
  struct Eye {
    Mount mount;             // along x
    double opening_rad = 0;  // full angle of its cone; 0: sees all round
    bool sees_lamps = true;  // false: sees only ambient light
    /// The maximum of red, green and blue that the eye sees; all maxima together read 1. An eye with a colour
    /// sees only lamps, equally in its whole cone. Not black.
    std::optional<Vector3> color;
  };
  std::vector<Eye> eyes;
  ValueNoise noise;

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  NumberedNames values() const { return {"light", "", eyes.size()}; }
};

/// Colour, depth and segmentation images of a pinhole camera that looks along x.
struct CameraModel {
  static constexpr const char* kType = "camera";
  static constexpr SensorElement kElement{"coopdyn:camera"};
  static constexpr int kMaxWidth = 4096, kMaxHeight = 4096;
  Mount mount;
  int width = 320, height = 240;
  double horizontal_fov_rad = 1.047;
  double near_m = 0.01, far_m = 100;  // depth reads 0 if nearer and inf if further
  ValueNoise noise;                   // of each colour channel, 0…1
  ValueNoise depth_noise;             // m

  double focal_px() const;  // of both axes

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  /// What must hold for every element: what to write instead; empty if valid.
  std::string Wrong() const;
};

/// The charge of a battery that powers the motors.
struct BatteryModel {
  static constexpr const char* kType = "battery";
  static constexpr SensorElement kElement{"coopdyn:battery", "<coopdyn:battery capacity=\"1e5\"/>"};
  static constexpr std::array kValues{"energy_j", "fraction", "power_w"};
  double capacity_j = 0;
  double start = 1;       // initial charge, fraction
  double idle_w = 0;      // constant power
  double efficiency = 1;  // of motors, which draw |τ ω| / efficiency

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  /// Energy J and power W.
  static constexpr std::size_t measured() { return 2; }
};

/// The pose estimated from the wheel encoders, in the initial R.
struct OdometryModel {
  static constexpr const char* kType = "odometry";
  static constexpr SensorElement kElement{"coopdyn:odometry"};
  static constexpr std::array kValues{"x_m", "y_m", "heading_rad", "forward_m_s", "turn_rad_s"};
  double resolution_rad = 0;  // of the encoders; 0: exact
  double slip_stddev = 0;     // of each wheel's travel in a step, as a fraction of the travel

  void Read(const SensorSource& source);
  /// X, y, heading, forward speed, turn rate; then the counted travel of the left and the right wheel, rad.
  static constexpr std::size_t measured() { return 7; }
};

/// In the order of their ports. Run files store a sensor's kind as its index here: add new kinds at the end.
using SensorKind =
    std::variant<DistanceModel, TargetModel, PoseModel, NeighboursModel, CompassModel, SupportModel, ImuModel,
                 WrenchModel, LidarModel, ContactModel, SonarModel, InfraredModel, LightModel, CameraModel,
                 BatteryModel, OdometryModel, ChannelModel>;

/// Number of values that physics measures for a sensor in each step (Frame::measured). docs/formats.md lists
/// their meanings.
std::size_t MeasuredCount(const SensorKind& kind);

/// Number of values in a sensor's reading if that is fixed; for a contact sensor its number of zones. Else 0.
std::size_t FixedCount(const SensorKind& kind);

/// The names of these values, with units, e.g. ax_m_s2; numbered from 1 where there are many of a kind:
/// range1_m.
std::vector<std::string> FixedNames(const SensorKind& kind);

/// A sensor and its module.
struct SensorModel {
  std::string name;
  SensorKind kind;
  SensorTiming timing = {};

  const char* type() const {
    return std::visit([](const auto& one) { return one.kType; }, kind);
  }
};

}  // namespace coopdyn
