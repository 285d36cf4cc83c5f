// SPDX-License-Identifier: MIT
// What the sensors of a robot type are like. Constant once read; any thread. SI units; L is a link's frame, S
// a sensor's: x forward, y left, z up.
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

/// How a reading differs from the truth, in the reading's unit.
struct ValueNoise {
  double stddev = 0;     // Gaussian, anew in each sample
  double bias_mean = 0;  // of a Gaussian that is drawn once a run
  double bias_stddev = 0;
  double resolution = 0;  // the value is rounded to a multiple of it; 0: exact
  double uniform = 0;     // even between minus and plus this, anew in each sample

  bool exact() const {
    return stddev <= 0 && uniform <= 0 && bias_mean == 0 && bias_stddev <= 0 && resolution <= 0;
  }
  bool operator==(const ValueNoise&) const = default;
};

/// When a sensor takes samples, and how late it shows them.
struct SensorTiming {
  double rate_hz = 0;  // 0: in each step. Sample k is taken in the first step at or after k / rate_hz
  double delay_s = 0;  // the newest sample that is at least so old is shown

  bool each_step() const { return rate_hz <= 0 && delay_s <= 0; }
  bool operator==(const SensorTiming&) const = default;
};

// The kinds of sensors. kType is the word for such a module in a robot's SDF.

/// One range of a `distance` module: a sector sampled by several rays in the horizontal plane of its mount;
/// the smallest counts.
struct SectorModel {
  Pose X_RS;               // x along the sector's middle; its origin lies on the chassis surface
  double bearing_rad = 0;  // of the middle in R; 0 ahead, left positive
  double opening_rad = 0;  // full angle of the sector
  int rays = 1;            // spread evenly from edge to edge; one: the middle
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
  bool see_through = true;  // targets are seen through obstacles
  double distance_noise_stddev_m = 0;
  double bearing_noise_stddev_rad = 0;
};

/// Ground truth.
struct PoseModel {
  static constexpr const char* kType = "pose";
  int link = 0;  // which carries the frame R that it tells of
};

/// Range and bearing to robots nearby, and short broadcasts to them.
struct NeighboursModel {
  static constexpr const char* kType = "neighbours";
  double range_m = 0;          // of sight, between the robots' centres, in the plane
  double message_range_m = 0;  // of broadcasts; 0: it hears none
  double loss = 0;             // probability that one receiver misses a message, 0…1
  int delay_steps = 0;         // from sending to hearing, beyond the one step that every message takes
  static constexpr int kMaxDelaySteps = 99;  // frames keep the broadcasts of 100 steps
  double distance_noise_stddev_m = 0;
  double bearing_noise_stddev_rad = 0;
};

/// The heading of R in the world.
struct CompassModel {
  static constexpr const char* kType = "compass";
  double noise_stddev_rad = 0;
};

/// How far a load has moved the support that carries it: a link on passive joints.
struct SupportModel {
  static constexpr const char* kType = "support";
  std::string link;
  double height_m = 0;  // in R: where a load rests on it
  double noise_stddev_m = 0;
  double angle_noise_stddev_rad = 0;
};

/// Acceleration and turn rates, and how the sensor is turned in the world. A level frame at rest reads +g
/// upwards.
struct ImuModel {
  static constexpr const char* kType = "imu";
  Mount mount;
  std::array<ValueNoise, 3> turn_noise;          // about x, y, z: rad/s
  std::array<ValueNoise, 3> acceleration_noise;  // along x, y, z: m/s²
  double orientation_noise_stddev_rad = 0;       // about each axis
};

/// Force and torque that pass through a joint: of all that is fixed beyond it. Its joint is in no closed
/// loop.
struct WrenchModel {
  static constexpr const char* kType = "wrench";
  /// A part of a link, or all of it: what fixed joints have welded to it beyond the sensor's.
  struct Part {
    int link = 0;
    double mass_kg = 0;
    Pose X_LI;  // its centre of mass and principal axes
    Vector3 inertia_kg_m2 = Vector3::Zero();
    std::vector<std::size_t> collisions;  // index into LinkModel::collisions
  };

  std::string joint;  // as the file has it
  Mount mount;        // the frame in which it measures; its origin is the joint's
  /// false: what the parent does to the child, at rest +weight upwards; true: the other way round.
  bool on_parent = false;
  Part part;                // of the child
  std::vector<int> beyond;  // links that move against the child: all that hang on it
  std::array<ValueNoise, 3> force_noise, torque_noise;
};

/// Ranges along rays from one point, row by row from the lowest, each from right to left.
struct LidarModel {
  static constexpr const char* kType = "lidar";
  Mount mount;
  int columns = 1, rows = 1;
  double first_azimuth_rad = 0, last_azimuth_rad = 0;      // of the first and the last column
  double first_elevation_rad = 0, last_elevation_rad = 0;  // of the lowest and the uppermost row
  double min_range_m = 0, max_range_m = 0;                 // nearer reads 0, further inf
  ValueNoise noise;

  std::size_t rays() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
};

/// What touches some of the robot's shapes.
struct ContactModel {
  static constexpr const char* kType = "contact";
  struct Part {
    int link = 0;
    std::size_t collision = 0;  // index into LinkModel::collisions
  };
  /// A part of a bumper: it is pressed by contacts whose bearing in R, from R's z axis, lies within.
  struct Zone {
    double bearing_rad = 0, opening_rad = 0;  // middle and full angle
  };
  std::vector<Part> parts;
  std::vector<Zone> zones;  // right to left; empty: one all round
  double threshold_n = 0;   // a zone is pressed by more force than this
};

/// Ultrasound: the range of the nearest thing in a cone, or on a few rays in it.
struct SonarModel {
  static constexpr const char* kType = "sonar";
  struct Beam {
    Mount mount;             // along x
    double opening_rad = 0;  // full angle of the cone
    double min_range_m = 0, max_range_m = 0;
    /// 0: the whole cone. Else the middle ray and rays - 1 round its rim, from the left upwards.
    int rays = 0;
    double opening_up_rad = 0;  // of rays: full angle up and down; `opening_rad` is that across
    ValueNoise noise = {};

    /// The direction of ray `index` in S.
    Vector3 Direction(int index) const;
  };
  std::vector<Beam> beams;
};

/// Infrared range finders: what they put out over the distance, by a table.
struct InfraredModel {
  static constexpr const char* kType = "infrared";
  struct Row {
    double distance_m = 0, value = 0, noise_stddev = 0;
  };
  std::vector<Mount> eyes;  // along x
  std::vector<Row> curve;   // by increasing distance, at least two; linear in between, as at its ends beyond
  double opening_rad = 0;   // full angle; the nearest of `rays` in its plane counts
  int rays = 1;
  double max_range_m = 0;  // nothing nearer: `dark`
  double dark = 0;
  ValueNoise noise;  // beside that of the curve
};

/// Light-dependent resistors, and sensors of the light all round.
struct LightModel {
  static constexpr const char* kType = "light";
  struct Eye {
    Mount mount;             // along x
    double opening_rad = 0;  // full angle of its cone; 0: it sees all round
    bool sees_lamps = true;  // false: the ambient light alone
    /// Of red, green and blue it sees up to so much, and all of that reads 1. With it the eye sees lamps
    /// alone, all alike within its cone. Not black.
    std::optional<Vector3> color;
  };
  std::vector<Eye> eyes;
  ValueNoise noise;
};

/// Colour, depth and segmentation as a pinhole camera sees them, along x.
struct CameraModel {
  static constexpr const char* kType = "camera";
  static constexpr int kMaxWidth = 4096, kMaxHeight = 4096;
  Mount mount;
  int width = 320, height = 240;
  double horizontal_fov_rad = 1.047;
  double near_m = 0.01, far_m = 100;  // depth reads 0 nearer and inf beyond
  ValueNoise noise;                   // of each of red, green and blue, 0…1
  ValueNoise depth_noise;             // m

  double focal_px() const;  // of both axes
};

/// What is left of a battery that drives the motors.
struct BatteryModel {
  static constexpr const char* kType = "battery";
  double capacity_j = 0;
  double start = 1;       // fraction
  double idle_w = 0;      // always drawn
  double efficiency = 1;  // of motors: |τ ω| / efficiency is drawn
};

/// Where the wheels' encoders say that the robot is, in R as it started.
struct OdometryModel {
  static constexpr const char* kType = "odometry";
  double resolution_rad = 0;  // of the encoders; 0: exact
  double slip_stddev = 0;     // of each wheel's way in a step, as a part of the way
};

/// In the order of their ports. A recorded run has a sensor's kind by its place here: add at the end.
using SensorKind =
    std::variant<DistanceModel, TargetModel, PoseModel, NeighboursModel, CompassModel, SupportModel, ImuModel,
                 WrenchModel, LidarModel, ContactModel, SonarModel, InfraredModel, LightModel, CameraModel,
                 BatteryModel, OdometryModel, ChannelModel>;

/// How many values physics measures for a sensor in each step (Frame::measured); docs/formats.md has their
/// meaning.
std::size_t MeasuredCount(const SensorKind& kind);

/// How many values the reading of a sensor has if that does not vary; of a contact sensor its zones.
std::size_t FixedCount(const SensorKind& kind);

/// A sensor, and its module.
struct SensorModel {
  std::string name;
  SensorKind kind;
  SensorTiming timing = {};

  const char* type() const {
    return std::visit([](const auto& one) { return one.kType; }, kind);
  }
};

}  // namespace coopdyn
