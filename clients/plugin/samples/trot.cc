// SPDX-License-Identifier: MIT
// Walks the quadruped of robots/ by a trot: two diagonally opposite legs swing while the other two carry it.
// Each foot follows a path below its hip; two-link inverse kinematics gives the joints. Works for robots of
// the same build: joints LEG_roll, LEG_pitch, LEG_knee with LEG as below, and feet under the hips at the
// start.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "cpp_controller.h"

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::array kLegs = {"front_left", "front_right", "rear_left", "rear_right"};
constexpr double kStandFirst_s = 0.5, kSpeedUp_s = 1;
constexpr double kSwing = 0.4;  // share of a period that a foot is in the air; all four carry in between

/// A leg in its plane: angles of thigh and shank from the vertical, positive backwards.
struct Leg {
  size_t roll = 0, pitch = 0, knee = 0;  // its channels
  double x_m = 0, y_m = 0;               // of its hip
  double thigh_m = 0, shank_m = 0, height_m = 0;
  double thigh_rad = 0, shank_rad = 0;  // at the start
};

class Trot {
 public:
  struct State {
    double heading_rad;     // wanted
    double phase;           // share of a period
    double offset_m[4][2];  // of each foot from its path, to catch the body
    uint32_t walks;         // 1: heading is set
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"speed", "forward, m/s", 0.3, -0.6, 0.6},
        {"turn", "to the left, rad/s", 0, -1, 1},
        {"period", "of two steps, s", 0.3, 0.1, 2},
        {"lift", "of a swinging foot, m", 0.04, 0.005, 0.1},
    };
    static const coopdyn_description description = {
        "walks a quadruped by a trot", COOPDYN_MOTION | COOPDYN_SETPOINTS, sizeof(State), 4, options};
    return &description;
  }

  Trot(const coopdyn_robot& robot, const double* options)
      : speed_m_s_(options[0]), turn_rad_s_(options[1]), period_s_(options[2]), lift_m_(options[3]) {
    constexpr double kFootRadius_m = 0.02;
    for (size_t i = 0; i < kLegs.size(); ++i) {
      Leg& leg = legs_[i];
      const std::string name = kLegs[i];
      leg.roll = Find(robot, name + "_roll");
      leg.pitch = Find(robot, name + "_pitch");
      leg.knee = Find(robot, name + "_knee");
      const double* hip = robot.channels[leg.pitch].point_m;
      const double* knee = robot.channels[leg.knee].point_m;
      leg.x_m = hip[0];
      leg.y_m = hip[1];
      leg.height_m = hip[2] - kFootRadius_m;
      leg.thigh_m = coopdyn_hypot(hip[0] - knee[0], hip[2] - knee[2]);
      leg.shank_m = coopdyn_hypot(hip[0] - knee[0], knee[2] - kFootRadius_m);
      leg.thigh_rad = coopdyn_atan2(hip[0] - knee[0], hip[2] - knee[2]);
      leg.shank_rad = coopdyn_atan2(knee[0] - hip[0], knee[2] - kFootRadius_m);
    }
  }

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    if (state.walks == 0) state.heading_rad = readings.heading_rad;
    const double walked_s = readings.time_s - kStandFirst_s;
    const double share = std::clamp(walked_s / kSpeedUp_s, 0.0, 1.0);
    if (walked_s > 0) {
      state.walks = 1;
      state.heading_rad += share * turn_rad_s_ * readings.step_s;
      state.phase = std::fmod(state.phase + readings.step_s / period_s_, 1.0);
    }
    const double off = std::remainder(state.heading_rad - readings.heading_rad, 2 * kPi);
    const double turn = share * turn_rad_s_ + std::clamp(2 * off, -0.8, 0.8) * (walked_s > 0 ? 1 : 0);
    const double forward_m_s = share * speed_m_s_;
    for (size_t i = 0; i < legs_.size(); ++i) {
      const Leg& leg = legs_[i];
      const bool second = i == 1 || i == 2;
      const double phase = std::fmod(state.phase + (second ? 0.5 : 0), 1.0);
      const bool swings = phase < kSwing && walked_s > 0;
      // Forwards in the swing, and back on the floor.
      const double s = swings ? phase / kSwing : (phase - kSwing) / (1 - kSwing);
      const double along = walked_s <= 0 ? 0 : swings ? -coopdyn_cos(kPi * s) : 1 - 2 * s;
      const double half_s = period_s_ * (1 - kSwing) / 2;
      const double raised_m = swings ? lift_m_ * coopdyn_sin(kPi * s) * coopdyn_sin(kPi * s) : 0;
      if (swings) {
        // A foot touches down where it corrects the body's velocity (Raibert).
        const double aim_m[] = {0.06 * (readings.velocity_m_s[0] - forward_m_s),
                                0.12 * readings.velocity_m_s[1]};
        for (size_t axis = 0; axis < 2; ++axis) {
          double& offset_m = state.offset_m[i][axis];
          const double near = std::min(1.0, readings.step_s / (0.3 * kSwing * period_s_));
          offset_m += near * (std::clamp(aim_m[axis], -0.06, 0.06) - offset_m);
        }
      }
      Place(leg, along * half_s * (forward_m_s - turn * leg.y_m) + state.offset_m[i][0],
            along * half_s * turn * leg.x_m + state.offset_m[i][1], raised_m, command);
    }
  }

 private:
  static size_t Find(const coopdyn_robot& robot, const std::string& joint) {
    for (size_t i = 0; i < robot.channel_count; ++i) {
      if (joint == robot.channels[i].name && (robot.channels[i].modes >> COOPDYN_DIRECT & 1) != 0) return i;
    }
    throw std::runtime_error("the robot has no driven joint " + joint);
  }

  /// Puts a foot at x, y from its place at the start and z above it.
  static void Place(const Leg& leg, double x_m, double y_m, double z_m, coopdyn_command& command) {
    const double down_m = leg.height_m - z_m;
    const double roll = coopdyn_atan2(y_m, down_m);
    const double reach =
        std::min(coopdyn_hypot(x_m, coopdyn_hypot(y_m, down_m)), 0.999 * (leg.thigh_m + leg.shank_m));
    const double towards = coopdyn_atan2(-x_m, coopdyn_hypot(y_m, down_m));
    const auto corner = [reach](double near, double far) {
      return coopdyn_acos(
          std::clamp((near * near + reach * reach - far * far) / (2 * near * reach), -1.0, 1.0));
    };
    const double thigh = towards + corner(leg.thigh_m, leg.shank_m);
    const double shank = towards - corner(leg.shank_m, leg.thigh_m);
    command.setpoints[leg.roll] = {COOPDYN_DIRECT, roll};
    command.setpoints[leg.pitch] = {COOPDYN_DIRECT, thigh - leg.thigh_rad};
    command.setpoints[leg.knee] = {COOPDYN_DIRECT, (shank - thigh) - (leg.shank_rad - leg.thigh_rad)};
  }

  const double speed_m_s_, turn_rad_s_, period_s_, lift_m_;
  std::array<Leg, 4> legs_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Trot>();
}
