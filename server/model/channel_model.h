// SPDX-License-Identifier: MIT
// A robot's channel: all motor and sensor values that its program exchanges in one request, mapped. Internal
// values are in SI units or in the unit of a module's reading; external values are the exchanged ones.
// Immutable once read; thread-safe.
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
struct RobotModel;
struct SensorSource;

/// The element of a model file that describes a sensor.
struct SensorElement {
  std::string_view name = {};     // empty: there is none
  std::string_view example = {};  // empty: the sensor needs no element
  bool has_timing = true;
};

/// The place where a sensor is mounted.
struct Mount {
  int link = 0;  // index into RobotModel::links
  Pose X_LS;
};

/// The line through (internal_min, external_min) and (internal_max, external_max). Values are clamped to its
/// ends. The external range may be decreasing. An infinite range leaves values unchanged.
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

/// Noise that is drawn in each step and added to an external value before it is clamped.
struct MappedNoise {
  enum class Kind { kNone, kUniform, kGaussian };
  Kind kind = Kind::kNone;
  double mean = 0;
  double sigma = 0;  // uniform: maximum deviation from the mean; Gaussian: standard deviation
};

/// Smooths an external value from step to step, after the noise is added and before clamping. Its state is
/// part of the channel's measured values (Frame::measured): the number of values so far, then
/// - mean, median: these values, newest first;
/// - low pass: its output.
struct ValueFilter {
  enum class Kind { kNone, kMean, kMedian, kLowPass };
  static constexpr int kMaxSteps = 100;
  Kind kind = Kind::kNone;
  int steps = 1;      // mean and median: number of latest values
  double time_s = 0;  // low pass: time constant

  std::size_t cells() const {
    if (kind == Kind::kNone) return 0;
    return kind == Kind::kLowPass ? 2 : 1 + static_cast<std::size_t>(steps);
  }
};

struct ChannelModel {
  static constexpr const char* kType = "channel";
  static constexpr SensorElement kElement{"coopdyn:channel", "<coopdyn:channel>", false};
  static constexpr std::size_t kMaxValues = 10'000;

  struct Motor {
    std::string name;
    std::string joint;
    ControlMode mode{};
    ValueMap map;
    MappedNoise noise;
    static constexpr std::size_t kNone = ~std::size_t{0};
    std::size_t channel = 0;  // index among the robot's channels; kNone: no effect
    int line = 0;             // in the file, for messages
  };

  /// The source of a value: a module's first reading, a joint, a place on a link, or the world.
  enum class Quantity {
    kReading,   // a value of a module's first reading
    kPosition,  // of a joint: rad or m
    kVelocity,
    kEffort,   // of the joint's motor; without a motor of its spring and damper: N m or N
    kCurrent,  // of the joint's drive train: A
    kEnergy,   // drawn by the joint's drive train, or given and absorbed by its motor: J
    kX,        // of a place, in the world: m
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
    std::string name;  // consecutive values with the same name are one sensor with several values
    Quantity quantity = Quantity::kReading;
    std::string of;          // name of the module or joint
    std::size_t index = 0;   // into the reading
    bool in_body = false;    // velocities along the place's own axes
    bool auxiliary = false;  // for the experimenter, not for the controller
    Mount mount;
    ValueMap map;
    MappedNoise noise;
    ValueFilter filter;
    bool sums_work = false;      // energy of a motor without a drive train, which is measured
    bool counts_turns = false;   // position of a hinge without a motor, measured beyond ±π
    std::size_t channel = 0;     // if sums_work: index among the robot's channels
    std::size_t source = 0;      // index into the sensors or joints
    std::size_t first_cell = 0;  // into the channel's measured values: own energy or angle, then filter state
    int line = 0;
    bool is_filtered() const { return filter.kind != ValueFilter::Kind::kNone; }
    std::size_t own_cells() const { return sums_work || counts_turns ? 1 : 0; }
    std::size_t cells() const { return own_cells() + filter.cells(); }
    /// The filter's cells in `cells`, the channel's measured values.
    template <typename Cell>
    std::span<Cell> FilterCells(std::span<Cell> cells) const {
      return cells.subspan(first_cell + own_cells(), filter.cells());
    }
  };

  std::vector<Motor> motors;
  std::vector<Value> values;
  int steps = 1;                    // per exchange
  int port = 0;                     // TCP port; 0: the next free port of all channels
  std::vector<std::string> abort;   // contact modules that end a trial when pressed
  std::vector<std::size_t> aborts;  // index into the sensors

  /// True if some value depends on earlier steps.
  bool remembers() const {
    return std::ranges::any_of(values, [](const Value& v) { return v.is_filtered() || v.counts_turns; });
  }
  std::size_t cells() const { return values.empty() ? 0 : values.back().first_cell + values.back().cells(); }

  void Read(const SensorSource& source);
  std::string Text(const RobotModel& robot) const;
  /// The values' names; adjacent ones of the same name are numbered.
  std::vector<std::string> ValueNames() const;
  /// The energies, angles and filter states of its values.
  std::size_t measured() const { return cells(); }
};

/// The word for a quantity: position, vx, …; empty for kReading.
std::string_view ToString(ChannelModel::Quantity quantity);

}  // namespace coopdyn
