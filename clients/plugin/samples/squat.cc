// SPDX-License-Identifier: MIT
// Makes the humanoid of robots/ bend its knees and rise again, with flat feet and an upright trunk. The
// ankles react to its lean, so that it withstands a push.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "cpp_controller.h"

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kLeastSink_m = 0.004;
constexpr double kAnswer_s = 0.1;  // time constant of the ankles

struct Leg {
  size_t hip_pitch = 0, knee = 0, ankle_pitch = 0, hip_roll = 0, ankle_roll = 0;
  double thigh_m = 0, shank_m = 0;
};

class Squat {
 public:
  struct State {
    double pitch_rad, roll_rad;  // ankle angles
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"depth", "by which the hips sink, m", 0.1, 0, 0.2},
        {"period", "down and up again, s", 4, 0.5, 60},
        {"wait", "before the first time, s", 1, 0, 1000},
        {"balance", "turn of the ankles by the lean of the trunk", 0.4, 0, 2},
    };
    static const coopdyn_description description = {"bends a humanoid's knees and rises again",
                                                    COOPDYN_MOTION | COOPDYN_SETPOINTS, sizeof(State), 4,
                                                    options};
    return &description;
  }

  Squat(const coopdyn_robot& robot, const double* options)
      : robot_(robot),
        depth_m_(options[0]),
        period_s_(options[1]),
        wait_s_(options[2]),
        balance_(options[3]) {
    for (size_t side = 0; side < legs_.size(); ++side) {
      const std::string name = side == 0 ? "left_" : "right_";
      Leg& leg = legs_[side];
      leg.hip_pitch = Find(name + "hip_pitch");
      leg.hip_roll = Find(name + "hip_roll");
      leg.knee = Find(name + "knee");
      leg.ankle_pitch = Find(name + "ankle_pitch");
      leg.ankle_roll = Find(name + "ankle_roll");
      leg.thigh_m = robot.channels[leg.hip_pitch].point_m[2] - robot.channels[leg.knee].point_m[2];
      leg.shank_m = robot.channels[leg.knee].point_m[2] - robot.channels[leg.ankle_pitch].point_m[2];
      if (leg.thigh_m <= 0 || leg.shank_m <= 0) throw std::runtime_error("its knees must lie below its hips");
    }
  }

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    // Hold all other joints at 0.
    for (size_t i = 0; i < robot_.channel_count; ++i) {
      if ((robot_.channels[i].modes >> COOPDYN_DIRECT & 1) != 0) command.setpoints[i] = {COOPDYN_DIRECT, 0};
    }
    const double bent_s = std::max(0.0, readings.time_s - wait_s_);
    // Once bent, never straighten the knees fully: near there a small height change needs a large angle.
    const double least_m = bent_s < period_s_ / 2 ? 0 : std::min(kLeastSink_m, depth_m_);
    const double sink_m =
        least_m + (depth_m_ - least_m) * (1 - coopdyn_cos(2 * kPi * bent_s / period_s_)) / 2;
    // Filter the ankles: if they react at once, the feet chatter.
    const double share = readings.step_s / (kAnswer_s + readings.step_s);
    state.pitch_rad +=
        share * (Lean(readings.pitch_rad, readings.angular_velocity_rad_s[1]) - state.pitch_rad);
    state.roll_rad += share * (Lean(readings.roll_rad, readings.angular_velocity_rad_s[0]) - state.roll_rad);
    for (const Leg& leg : legs_) {
      const double height_m = leg.thigh_m + leg.shank_m - sink_m;
      const auto corner = [height_m](double near, double far) {
        const double cosine = (near * near + height_m * height_m - far * far) / (2 * near * height_m);
        return coopdyn_acos(std::clamp(cosine, -1.0, 1.0));
      };
      const double thigh = corner(leg.thigh_m, leg.shank_m), shank = corner(leg.shank_m, leg.thigh_m);
      command.setpoints[leg.hip_pitch] = {COOPDYN_DIRECT, -thigh};
      command.setpoints[leg.knee] = {COOPDYN_DIRECT, thigh + shank};
      command.setpoints[leg.ankle_pitch] = {COOPDYN_DIRECT, -shank + state.pitch_rad};
      command.setpoints[leg.ankle_roll] = {COOPDYN_DIRECT, state.roll_rad};
    }
  }

 private:
  /// The ankle angle against a lean.
  double Lean(double angle_rad, double rate_rad_s) const {
    constexpr double kAhead_s = 0.3, kMost_rad = 0.1;
    return std::clamp(balance_ * (angle_rad + kAhead_s * rate_rad_s), -kMost_rad, kMost_rad);
  }

  size_t Find(const std::string& joint) const {
    for (size_t i = 0; i < robot_.channel_count; ++i) {
      if (joint == robot_.channels[i].name && (robot_.channels[i].modes >> COOPDYN_DIRECT & 1) != 0) return i;
    }
    throw std::runtime_error("the robot has no driven joint " + joint);
  }

  const coopdyn_robot& robot_;
  const double depth_m_, period_s_, wait_s_, balance_;
  std::array<Leg, 2> legs_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Squat>();
}
