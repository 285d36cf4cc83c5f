// SPDX-License-Identifier: MIT
// Walks the hexapod of robots/ by a tripod gait: three legs carry it while the other three swing. Each foot
// follows a straight path in the body's frame; inverse kinematics gives the leg's three joints. Works for
// robots of the same build: joints LEG_yaw, LEG_lift, LEG_knee with LEG as below.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "cpp_controller.h"

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::array kLegs = {"front_left",   "front_right", "middle_left",
                              "middle_right", "rear_left",   "rear_right"};
constexpr std::array kFirst = {true, false, false, true, true, false};  // swing together
constexpr double kStandFirst_s = 0.5, kSpeedUp_s = 1;
constexpr double kFootRadius_m = 0.01;

struct Leg {
  size_t yaw = 0, lift = 0, knee = 0;  // its channels
  double hip_m[2] = {0, 0};
  double direction_rad = 0;                     // of the leg at the start
  double coxa_m = 0, femur_m = 0, tibia_m = 0;  // lengths
  double out_m = 0, down_m = 0;                 // of the foot from the lift joint, at the start
  double femur_rad = 0, tibia_rad = 0;          // at the start, up positive
};

class Tripod {
 public:
  struct State {
    double heading_rad;  // wanted
    double phase;        // share of a period
    uint32_t walks;      // 1: heading is set
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"speed", "forward, m/s", 0.12, -0.3, 0.3},
        {"turn", "to the left, rad/s", 0, -1, 1},
        {"period", "of two steps, s", 0.6, 0.2, 5},
        {"lift", "of a swinging foot, m", 0.03, 0.005, 0.1},
        {"tibia", "from knee to foot, m", 0.133, 0.01, 1},
    };
    static const coopdyn_description description = {
        "walks a hexapod by a tripod gait", COOPDYN_MOTION | COOPDYN_SETPOINTS, sizeof(State), 5, options};
    return &description;
  }

  Tripod(const coopdyn_robot& robot, const double* options)
      : speed_m_s_(options[0]), turn_rad_s_(options[1]), period_s_(options[2]), lift_m_(options[3]) {
    for (size_t i = 0; i < kLegs.size(); ++i) {
      Leg& leg = legs_[i];
      const std::string name = kLegs[i];
      leg.yaw = Find(robot, name + "_yaw");
      leg.lift = Find(robot, name + "_lift");
      leg.knee = Find(robot, name + "_knee");
      const double* hip = robot.channels[leg.yaw].point_m;
      const double* lift = robot.channels[leg.lift].point_m;
      const double* knee = robot.channels[leg.knee].point_m;
      leg.hip_m[0] = hip[0];
      leg.hip_m[1] = hip[1];
      leg.direction_rad = coopdyn_atan2(lift[1] - hip[1], lift[0] - hip[0]);
      leg.coxa_m = coopdyn_hypot(lift[0] - hip[0], lift[1] - hip[1]);
      const double femur_out_m = coopdyn_hypot(knee[0] - lift[0], knee[1] - lift[1]);
      leg.femur_m = coopdyn_hypot(femur_out_m, knee[2] - lift[2]);
      leg.tibia_m = options[4];
      const double fall_m = knee[2] - kFootRadius_m;
      if (fall_m >= leg.tibia_m) throw std::runtime_error("the tibia is too short to reach the floor");
      const double tibia_out_m = std::sqrt(leg.tibia_m * leg.tibia_m - fall_m * fall_m);
      leg.out_m = femur_out_m + tibia_out_m;
      leg.down_m = lift[2] - kFootRadius_m;
      leg.femur_rad = coopdyn_atan2(knee[2] - lift[2], femur_out_m);
      leg.tibia_rad = coopdyn_atan2(-fall_m, tibia_out_m);
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
    const double turn = share * (turn_rad_s_ + std::clamp(off, -0.5, 0.5));
    for (size_t i = 0; i < legs_.size(); ++i) {
      const Leg& leg = legs_[i];
      const double phase = std::fmod(state.phase + (kFirst[i] ? 0 : 0.5), 1.0);
      const bool swings = phase < 0.5 && walked_s > 0;
      const double s = swings ? phase / 0.5 : (phase - 0.5) / 0.5;
      const double along = walked_s > 0 ? (swings ? -coopdyn_cos(kPi * s) : 1 - 2 * s) : 0;
      const double raised_m = swings ? lift_m_ * coopdyn_sin(kPi * s) * coopdyn_sin(kPi * s) : 0;
      const double reach_m = leg.coxa_m + leg.out_m;
      const double foot_x_m = leg.hip_m[0] + reach_m * coopdyn_cos(leg.direction_rad);
      const double foot_y_m = leg.hip_m[1] + reach_m * coopdyn_sin(leg.direction_rad);
      const double quarter_s = period_s_ / 4;
      const double x_m = foot_x_m + along * (share * speed_m_s_ - turn * foot_y_m) * quarter_s;
      const double y_m = foot_y_m + along * turn * foot_x_m * quarter_s;
      Place(leg, x_m, y_m, raised_m, command);
    }
  }

 private:
  static size_t Find(const coopdyn_robot& robot, const std::string& joint) {
    for (size_t i = 0; i < robot.channel_count; ++i) {
      if (joint == robot.channels[i].name && (robot.channels[i].modes >> COOPDYN_DIRECT & 1) != 0) return i;
    }
    throw std::runtime_error("the robot has no driven joint " + joint);
  }

  /// Puts a foot at x, y in the robot's frame and z above the floor.
  static void Place(const Leg& leg, double x_m, double y_m, double z_m, coopdyn_command& command) {
    const double dx = x_m - leg.hip_m[0], dy = y_m - leg.hip_m[1];
    const double yaw = std::remainder(coopdyn_atan2(dy, dx) - leg.direction_rad, 2 * kPi);
    const double out_m = coopdyn_hypot(dx, dy) - leg.coxa_m, down_m = leg.down_m - z_m;
    const double reach = std::min(coopdyn_hypot(out_m, down_m), 0.999 * (leg.femur_m + leg.tibia_m));
    const double towards = coopdyn_atan2(-down_m, out_m);
    const auto corner = [reach](double near, double far) {
      return coopdyn_acos(
          std::clamp((near * near + reach * reach - far * far) / (2 * near * reach), -1.0, 1.0));
    };
    const double femur = towards + corner(leg.femur_m, leg.tibia_m);
    const double tibia = towards - corner(leg.tibia_m, leg.femur_m);
    command.setpoints[leg.yaw] = {COOPDYN_DIRECT, yaw};
    command.setpoints[leg.lift] = {COOPDYN_DIRECT, femur - leg.femur_rad};
    command.setpoints[leg.knee] = {COOPDYN_DIRECT, (tibia - femur) - (leg.tibia_rad - leg.femur_rad)};
  }

  const double speed_m_s_, turn_rad_s_, period_s_, lift_m_;
  std::array<Leg, 6> legs_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Tripod>();
}
