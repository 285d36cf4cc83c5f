// SPDX-License-Identifier: MIT
// Descriptions of the sensors of a robot type. Immutable once read; thread-safe. SI units. L is a link's
// frame, S a sensor's: x forward, y left, z up.
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

// The kinds of sensors. kType is the type of the module in a robot's SDF.

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
  std::vector<SectorModel> sectors;  // by increasing bearing (right to left)
};

/// Vision: targets and other robots by distance and bearing.
struct TargetModel {
  static constexpr const char* kType = "target";
  double max_range_m = std::numeric_limits<double>::infinity();
  bool see_through = true;  // obstacles do not hide targets
  double distance_noise_stddev_m = 0;
  double bearing_noise_stddev_rad = 0;
};

/// Ground truth.
struct PoseModel {
  static constexpr const char* kType = "pose";
  int link = 0;  // the link that carries the reported frame R
};

/// Range and bearing to robots nearby, and short broadcasts to them.
struct NeighboursModel {
  static constexpr const char* kType = "neighbours";
  double range_m = 0;                        // of sight, between the robots' centres, in the plane
  double message_range_m = 0;                // of broadcasts; 0: receives none
  double loss = 0;                           // probability that a receiver loses a message, 0…1
  int delay_steps = 0;                       // extra delay beyond the one step of every message
  static constexpr int kMaxDelaySteps = 99;  // frames keep the broadcasts of 100 steps
  double distance_noise_stddev_m = 0;
  double bearing_noise_stddev_rad = 0;
};

/// The heading of R in the world.
struct CompassModel {
  static constexpr const char* kType = "compass";
  double noise_stddev_rad = 0;
};

/// The displacement, caused by a load, of the support that carries it: a link on passive joints.
struct SupportModel {
  static constexpr const char* kType = "support";
  std::string link;
  double height_m = 0;  // in R, where the load rests
  double noise_stddev_m = 0;
  double angle_noise_stddev_rad = 0;
};

/// Acceleration, angular velocity and orientation of the sensor. At rest and level, it reads +g upwards.
struct ImuModel {
  static constexpr const char* kType = "imu";
  Mount mount;
  std::array<ValueNoise, 3> turn_noise;          // about x, y, z: rad/s
  std::array<ValueNoise, 3> acceleration_noise;  // along x, y, z: m/s²
  double orientation_noise_stddev_rad = 0;       // about each axis
};

/// Force and torque through a joint, from everything beyond it. The joint is not part of a closed loop.
struct WrenchModel {
  static constexpr const char* kType = "wrench";
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
};

/// Ranges along rays from one point, row by row from the lowest, each row from right to left.
struct LidarModel {
  static constexpr const char* kType = "lidar";
  Mount mount;
  int columns = 1, rows = 1;
  double first_azimuth_rad = 0, last_azimuth_rad = 0;      // of the first and the last column
  double first_elevation_rad = 0, last_elevation_rad = 0;  // of the lowest and the highest row
  double min_range_m = 0, max_range_m = 0;                 // nearer reads 0, further reads inf
  ValueNoise noise;

  std::size_t rays() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
};

/// Contacts of some of the robot's shapes.
struct ContactModel {
  static constexpr const char* kType = "contact";
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
};

/// Ultrasound: the range of the nearest thing within a cone, or along a few rays in it.
struct SonarModel {
  static constexpr const char* kType = "sonar";
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
};

/// Infrared range finders, with a table of their output over distance.
struct InfraredModel {
  static constexpr const char* kType = "infrared";
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
};

/// Light-dependent resistors, and sensors of ambient light.
struct LightModel {
  static constexpr const char* kType = "light";
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
};

/// Colour, depth and segmentation images of a pinhole camera that looks along x.
struct CameraModel {
  static constexpr const char* kType = "camera";
  static constexpr int kMaxWidth = 4096, kMaxHeight = 4096;
  Mount mount;
  int width = 320, height = 240;
  double horizontal_fov_rad = 1.047;
  double near_m = 0.01, far_m = 100;  // depth reads 0 if nearer and inf if further
  ValueNoise noise;                   // of each colour channel, 0…1
  ValueNoise depth_noise;             // m

  double focal_px() const;  // of both axes
};

/// The charge of a battery that powers the motors.
struct BatteryModel {
  static constexpr const char* kType = "battery";
  double capacity_j = 0;
  double start = 1;       // initial charge, fraction
  double idle_w = 0;      // constant power
  double efficiency = 1;  // of motors, which draw |τ ω| / efficiency
};

/// The pose estimated from the wheel encoders, in the initial R.
struct OdometryModel {
  static constexpr const char* kType = "odometry";
  double resolution_rad = 0;  // of the encoders; 0: exact
  double slip_stddev = 0;     // of each wheel's travel in a step, as a fraction of the travel
};

/// In the order of their ports. Run files store a sensor's kind as its index here: add new kinds at the end.
using SensorKind =
    std::variant<DistanceModel, TargetModel, PoseModel, NeighboursModel, CompassModel, SupportModel, ImuModel,
                 WrenchModel, LidarModel, ContactModel, SonarModel, InfraredModel, LightModel, CameraModel,
                 BatteryModel, OdometryModel, ChannelModel>;

/// Number of values that physics measures for a sensor in each step (Frame::measured). docs/formats.md lists
/// their meanings.
std::size_t MeasuredCount(const SensorKind& kind);

/// Number of values in a sensor's reading if that is fixed; for a contact sensor its number of zones.
std::size_t FixedCount(const SensorKind& kind);

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
