// SPDX-License-Identifier: MIT
// A central pattern generator for robots with any number of legs. Each leg has an oscillator, and all
// oscillators pull each other towards the phases of the gait; the seed sets their start. The joints follow by
// waves whose amplitudes and offsets are options, so that a sweep can search for a gait. The joints of a leg
// are called LEG_swing (positive: the foot moves ahead), LEG_lift and LEG_knee (positive: it moves up); a leg
// needs only the first. The position of the swing joint tells whether a leg is left or right, ahead of or
// behind others.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "cpp_controller.h"

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr size_t kMostLegs = 32, kNone = SIZE_MAX;
constexpr double kSpeedUp_s = 1;

struct Leg {
  std::string name;
  size_t swing = kNone, lift = kNone, knee = kNone;  // its channels
  double x_m = 0, y_m = 0;
  double phase = 0;  // in the gait, share of a period
};

double Part(double phase) {
  return phase - std::floor(phase);
}

class Gait {
 public:
  struct State {
    double phase[kMostLegs];  // share of a period
    double size;              // amplitude of all waves: 0 at the start, then 1
    double heading_rad;       // wanted
    uint32_t walks;           // 1: phases and heading are set
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"frequency", "steps of a leg in a second", 1.5, 0.1, 10},
        {"air", "part of a period that a foot is in the air", 0.5, 0.1, 0.9},
        {"side", "phase of right legs after left ones, part of a period", 0.5, -1, 1},
        {"along", "phase of a leg after the one ahead of it, part of a period", 0.5, -1, 1},
        {"coupling", "how fast the phases come together, 1/s", 5, 0, 50},
        {"swing", "turn of the swing joints to each side, rad", 0.3, 0, 1.5},
        {"swing_offset", "their middle, rad", 0, -1.5, 1.5},
        {"lift", "turn of the lift joints in the air, rad", 0.3, -1.5, 1.5},
        {"lift_offset", "on the floor, rad", 0, -1.5, 1.5},
        {"lift_phase", "later than the swing, part of a period", 0, -0.5, 0.5},
        {"knee", "turn of the knees in the air, rad", 0, -2, 2},
        {"knee_offset", "on the floor, rad", 0, -2, 2},
        {"knee_phase", "later than the swing, part of a period", 0, -0.5, 0.5},
        {"steer", "how much shorter the steps of one side are for each rad off the heading at the start", 1,
         0, 10},
    };
    static const coopdyn_description description = {"walks on any number of legs by coupled oscillators",
                                                    COOPDYN_COMPASS | COOPDYN_SETPOINTS, sizeof(State), 14,
                                                    options};
    return &description;
  }

  Gait(const coopdyn_robot& robot, const double* options)
      : id_(robot.id),
        frequency_hz_(options[0]),
        air_(options[1]),
        coupling_1_s_(options[4]),
        swing_rad_(options[5]),
        swing_offset_rad_(options[6]),
        lift_{options[7], options[8], options[9]},
        knee_{options[10], options[11], options[12]},
        steer_(options[13]) {
    for (size_t i = 0; i < robot.channel_count; ++i) AddJoint(robot.channels[i], i);
    std::erase_if(legs_, [](const Leg& leg) { return leg.swing == kNone; });
    if (legs_.empty()) throw std::runtime_error("the robot has no driven joint LEG_swing");
    if (legs_.size() > kMostLegs) throw std::runtime_error("the robot has more than 32 legs");
    for (Leg& leg : legs_) {
      const auto ahead = std::count_if(legs_.begin(), legs_.end(), [&leg](const Leg& other) {
        return (other.y_m > 0) == (leg.y_m > 0) && other.x_m > leg.x_m + 1e-6;
      });
      leg.phase = static_cast<double>(ahead) * options[3] + (leg.y_m > 0 ? 0 : options[2]);
    }
  }

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    if (state.walks == 0) Begin(readings);
    Advance(readings.step_s);
    double off_rad = 0;
    if (std::isfinite(readings.compass_rad))
      off_rad = std::remainder(state.heading_rad - readings.compass_rad, 2 * kPi);
    for (size_t i = 0; i < legs_.size(); ++i) {
      const Leg& leg = legs_[i];
      const double turn = std::clamp(steer_ * off_rad, -1.0, 1.0) * (leg.y_m > 0 ? -1 : 1);
      const double swing_rad = swing_rad_ * std::min(1.0, 1 + turn);
      Set(command, leg.swing, swing_offset_rad_ - swing_rad * coopdyn_cos(kPi * Way(state.phase[i])));
      Set(command, leg.lift, Raised(lift_, state.phase[i]));
      Set(command, leg.knee, Raised(knee_, state.phase[i]));
    }
  }

 private:
  /// The motion of a joint in the air.
  struct Wave {
    double size_rad, offset_rad, phase;
  };

  void AddJoint(const coopdyn_joint& joint, size_t channel) {
    const std::string_view name = joint.name;
    const size_t end = name.rfind('_');
    if (end == std::string_view::npos || (joint.modes >> COOPDYN_DIRECT & 1) == 0) return;
    const std::string_view role = name.substr(end + 1);
    auto leg = std::find_if(legs_.begin(), legs_.end(),
                            [&](const Leg& one) { return one.name == name.substr(0, end); });
    if (leg == legs_.end()) {
      legs_.push_back({std::string(name.substr(0, end))});
      leg = legs_.end() - 1;
    }
    if (role == "swing") {
      leg->swing = channel;
      leg->x_m = joint.point_m[0];
      leg->y_m = joint.point_m[1];
    } else if (role == "lift") {
      leg->lift = channel;
    } else if (role == "knee") {
      leg->knee = channel;
    }
  }

  void Begin(const coopdyn_readings& readings) {
    state.walks = 1;
    state.heading_rad = readings.compass_rad;
    for (size_t i = 0; i < legs_.size(); ++i) {
      const double off = coopdyn::Random(readings.seed, id_, 0, static_cast<uint32_t>(i)) - 0.5;
      state.phase[i] = Part(legs_[i].phase + 0.4 * off);
    }
  }

  /// Advances the oscillators: each by its frequency and the pull of the others.
  void Advance(double step_s) {
    state.size = std::min(1.0, state.size + step_s / kSpeedUp_s);
    double next[kMostLegs];
    for (size_t i = 0; i < legs_.size(); ++i) {
      double pull = 0;
      for (size_t k = 0; k < legs_.size(); ++k)
        pull += coopdyn_sin(2 * kPi * (state.phase[k] - legs_[k].phase - state.phase[i] + legs_[i].phase));
      pull *= coupling_1_s_ / (2 * kPi * static_cast<double>(legs_.size()));
      next[i] = Part(state.phase[i] + step_s * (frequency_hz_ + pull));
    }
    std::copy_n(next, legs_.size(), state.phase);
  }

  /// From 0 (behind) to 1 (ahead) through the air, then to 2 on the floor.
  double Way(double phase) const { return phase < air_ ? phase / air_ : 1 + (phase - air_) / (1 - air_); }
  double Raised(const Wave& wave, double phase) const {
    return wave.offset_rad + wave.size_rad * std::max(0.0, coopdyn_sin(kPi * Way(Part(phase - wave.phase))));
  }
  void Set(coopdyn_command& command, size_t channel, double angle_rad) const {
    if (channel != kNone) command.setpoints[channel] = {COOPDYN_DIRECT, state.size * angle_rad};
  }

  const uint32_t id_;
  const double frequency_hz_, air_, coupling_1_s_, swing_rad_, swing_offset_rad_;
  const Wave lift_, knee_;
  const double steer_;
  std::vector<Leg> legs_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Gait>();
}
