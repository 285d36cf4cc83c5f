// SPDX-License-Identifier: MIT
// The channel of a robot: all motors and sensors that its program exchanges in one request, as mapped values.
// Internal values are SI units, or those of a module's reading; external ones are what is exchanged. Constant
// once read; any thread.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/geometry/shape.h"

namespace coopdyn {

enum class ControlMode : std::uint8_t;

/// Where a sensor is fixed.
struct Mount {
  int link = 0;  // index into RobotModel::links
  Pose X_LS;
};

/// The line through (internal_min, external_min) and (internal_max, external_max). A value beyond one end is
/// cut there. External values may fall. An infinite range leaves its values as they are.
struct ValueMap {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double internal_min = -kInfinity, internal_max = kInfinity;
  double external_min = -kInfinity, external_max = kInfinity;

  bool maps() const { return std::isfinite(internal_min) && std::isfinite(external_min); }
  double CutInternal(double value) const { return std::clamp(value, internal_min, internal_max); }
  double CutExternal(double value) const {
    return std::clamp(value, std::min(external_min, external_max), std::max(external_min, external_max));
  }
  double ToExternal(double internal) const {
    const double cut = CutInternal(internal);
    if (!maps()) return cut;
    return external_min +
           (cut - internal_min) / (internal_max - internal_min) * (external_max - external_min);
  }
  double ToInternal(double external) const {
    const double cut = CutExternal(external);
    if (!maps()) return CutInternal(cut);
    return CutInternal(internal_min +
                       (cut - external_min) / (external_max - external_min) * (internal_max - internal_min));
  }
};

/// Added to an external value, anew in each step; then it is cut.
struct MappedNoise {
  enum class Kind { kNone, kUniform, kGaussian };
  Kind kind = Kind::kNone;
  double mean = 0;
  double sigma = 0;  // uniform: the most that it differs from the mean; Gaussian: standard deviation
};

/// Smooths an external value from step to step, after the noise and before it is cut. Its memory is among the
/// measured values of the channel (Frame::measured): how many values it has taken, then
/// - mean, median: these values, the newest first;
/// - low pass: what it puts out.
struct ValueFilter {
  enum class Kind { kNone, kMean, kMedian, kLowPass };
  static constexpr int kMaxSteps = 100;
  Kind kind = Kind::kNone;
  int steps = 1;      // of mean and median: how many of the last values count
  double time_s = 0;  // of a low pass: its time constant

  std::size_t cells() const {
    if (kind == Kind::kNone) return 0;
    return kind == Kind::kLowPass ? 2 : 1 + static_cast<std::size_t>(steps);
  }
};

struct ChannelModel {
  static constexpr const char* kType = "channel";
  static constexpr std::size_t kMaxValues = 10'000;

  struct Motor {
    std::string name;
    std::string joint;
    ControlMode mode{};
    ValueMap map;
    MappedNoise noise;
    static constexpr std::size_t kNone = ~std::size_t{0};
    std::size_t channel = 0;  // of the robot's; kNone: it changes nothing
    int line = 0;             // of the file, for messages
  };

  /// What a value is: one of a module's first reading, of a joint, of a place on a link, or of the world.
  enum class Quantity {
    kReading,
    kPosition,  // joint: rad or m
    kVelocity,
    kEffort,   // of its motor; without one of its spring and damper: N m or N
    kCurrent,  // of its drive train: A
    kEnergy,   // that its drive train has drawn, or its motor given and taken: J
    kX,        // place, in the world: m
    kY,
    kZ,
    kRoll,  // rad
    kPitch,
    kYaw,
    kVx,  // m/s
    kVy,
    kVz,
    kWx,  // rad/s
    kWy,
    kWz,
    kAmbientLight,
  };

  struct Value {
    std::string name;  // of neighbours that are called alike: one sensor of several values
    Quantity quantity = Quantity::kReading;
    std::string of;          // the module or joint
    std::size_t index = 0;   // of the reading, from 0
    bool in_body = false;    // velocities along the place's own axes
    bool auxiliary = false;  // for the experimenter, not for the controller
    Mount mount;
    ValueMap map;
    MappedNoise noise;
    ValueFilter filter;
    bool sums_work = false;      // energy of a motor without a drive train: measured
    bool counts_turns = false;   // position of a hinge without a motor, beyond ±π: measured
    std::size_t channel = 0;     // if it sums work: of the robot's
    std::size_t source = 0;      // index into the sensors or joints
    std::size_t first_cell = 0;  // of the channel's measured values: its energy or angle, then its filter's
    int line = 0;
    bool is_filtered() const { return filter.kind != ValueFilter::Kind::kNone; }
    std::size_t own_cells() const { return sums_work || counts_turns ? 1 : 0; }
    std::size_t cells() const { return own_cells() + filter.cells(); }
    /// The cells of its filter among `cells` of the channel's measured values.
    template <typename Cell>
    std::span<Cell> FilterCells(std::span<Cell> cells) const {
      return cells.subspan(first_cell + own_cells(), filter.cells());
    }
  };

  std::vector<Motor> motors;
  std::vector<Value> values;
  int steps = 1;                    // of one exchange
  int port = 0;                     // where its clients look for it; 0: the next of all channels
  std::vector<std::string> abort;   // contact modules that end a try when they are pressed
  std::vector<std::size_t> aborts;  // index into the sensors

  /// Some value depends on steps before.
  bool remembers() const {
    return std::ranges::any_of(values, [](const Value& v) { return v.is_filtered() || v.counts_turns; });
  }
  std::size_t cells() const { return values.empty() ? 0 : values.back().first_cell + values.back().cells(); }
};

/// position, vx, …; empty for a reading.
std::string_view ToString(ChannelModel::Quantity quantity);

}  // namespace coopdyn
