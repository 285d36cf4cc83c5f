// SPDX-License-Identifier: MIT
// Walks the humanoid of robots/ straight ahead. The zero moment point (ZMP) stays in the standing foot and
// moves to the other foot while both stand. For a mass on a massless leg, the bounded path for all of the
// ZMP's past and future is
//   c(t) = ∫ ω/2 · exp(−ω |t − s|) · zmp(s) ds,   ω = √(g / height),
// so the whole motion is a function of time. The ankles react to a lean of the trunk.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "cpp_controller.h"

namespace {

constexpr double kOmega_1_s = 4.7;   // centre of mass 0.44 m above the floor
constexpr double kLegsShare = 0.22;  // share of a shift of the feet that moves the centre of mass
constexpr double kBothStand = 0.4;   // share of a step
constexpr double kSight_s = 1.6;     // farther away the weight is negligible
constexpr double kSlice_s = 0.02;

struct Point {
  double x = 0, y = 0, z = 0;
};

Point Between(const Point& a, const Point& b, double part) {
  return {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), a.z + part * (b.z - a.z)};
}

/// From 0 to 1 with minimum jerk.
double Smooth(double part) {
  const double u = std::clamp(part, 0.0, 1.0);
  return u * u * u * (10 + u * (6 * u - 15));
}

struct Leg {
  size_t hip_pitch = 0, hip_roll = 0, hip_yaw = 0, knee = 0, ankle_pitch = 0, ankle_roll = 0;
  double side_m = 0;  // of the hip and of the foot, left positive
  double thigh_m = 0, shank_m = 0;
};

class Walk {
 public:
  struct State {
    char nothing;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"length", "way forward of each step, m; 0: it steps in place", 0.06, 0, 0.12},
        {"period", "of one step, s", 0.8, 0.5, 10},
        {"lift", "of the foot, m", 0.03, 0.005, 0.05},
        {"wait", "before the first step, in which it bends its knees, s", 1, 0.5, 1000},
        {"steps", "after which it stands", 1000, 2, 1e6},
        {"balance", "turn of the ankles by the lean of the trunk", 0.3, 0, 2},
    };
    static const coopdyn_description description = {
        "lets a humanoid walk ahead", COOPDYN_MOTION | COOPDYN_SETPOINTS, sizeof(State), 6, options};
    return &description;
  }

  Walk(const coopdyn_robot& robot, const double* options)
      : robot_(robot),
        length_m_(options[0]),
        period_s_(options[1]),
        lift_m_(options[2]),
        wait_s_(options[3]),
        steps_(std::floor(options[4])),
        balance_(options[5]) {
    for (size_t side = 0; side < legs_.size(); ++side) {
      const std::string name = side == 0 ? "left_" : "right_";
      Leg& leg = legs_[side];
      leg.hip_pitch = Find(name + "hip_pitch");
      leg.hip_roll = Find(name + "hip_roll");
      leg.hip_yaw = Find(name + "hip_yaw");
      leg.knee = Find(name + "knee");
      leg.ankle_pitch = Find(name + "ankle_pitch");
      leg.ankle_roll = Find(name + "ankle_roll");
      leg.side_m = robot.channels[leg.hip_pitch].point_m[1];
      leg.thigh_m = robot.channels[leg.hip_pitch].point_m[2] - robot.channels[leg.knee].point_m[2];
      leg.shank_m = robot.channels[leg.knee].point_m[2] - robot.channels[leg.ankle_pitch].point_m[2];
      if (leg.thigh_m <= 0 || leg.shank_m <= 0) throw std::runtime_error("its knees must lie below its hips");
    }
  }

  void Reset(uint64_t /*seed*/) {}

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    // Hold all other joints at 0.
    for (size_t i = 0; i < robot_.channel_count; ++i) {
      if ((robot_.channels[i].modes >> COOPDYN_DIRECT & 1) != 0) command.setpoints[i] = {COOPDYN_DIRECT, 0};
    }
    const double time_s = readings.time_s + readings.step_s;  // when the set-points take effect
    const std::array<Point, 2> feet = {Foot(0, time_s), Foot(1, time_s)};
    const Point mass = CentreOfMass(time_s);
    const auto pelvis = [](double of_mass, double left, double right) {
      return (of_mass - kLegsShare * (left + right) / 2) / (1 - kLegsShare);
    };
    const Point hips = {pelvis(mass.x, feet[0].x, feet[1].x), pelvis(mass.y, feet[0].y, feet[1].y),
                        -kBend_m * Smooth(time_s / wait_s_)};
    const double pitch = Lean(readings.pitch_rad, readings.angular_velocity_rad_s[1]);
    const double roll = Lean(readings.roll_rad, readings.angular_velocity_rad_s[0]);
    for (size_t side = 0; side < legs_.size(); ++side) {
      const Leg& leg = legs_[side];
      const Point& foot = feet[side];
      Place(leg, {hips.x - foot.x, hips.y + leg.side_m - foot.y, leg.thigh_m + leg.shank_m + hips.z - foot.z},
            command.setpoints);
      command.setpoints[leg.ankle_pitch].reference += pitch;
      command.setpoints[leg.ankle_roll].reference += roll;
    }
  }

 private:
  static constexpr double kBend_m = 0.035;  // the hips sink by this, so that the legs reach sideways

  /// Where the foot of step number `step` lands; 0 before the first step.
  double Landing(double step) const {
    const double ahead = step + 1 < steps_ ? step + 1 : steps_ - 1;  // the last step brings the feet together
    return length_m_ * std::max(0.0, ahead);
  }

  /// Steps of even number move the right foot (1), others the left (0).
  static double Moves(double step) { return std::fmod(step, 2) == 0 ? 1 : 0; }

  /// Position of the foot in the world of a robot that started at 0.
  Point Foot(size_t side, double time_s) const {
    const double since = (time_s - wait_s_) / period_s_;
    double step = std::floor(since);
    double part = (since - step - kBothStand) / (1 - kBothStand);  // share of its way through the air
    if (step >= steps_) {
      step = steps_ - 1;
      part = 1;
    }
    const auto which = static_cast<double>(side);
    Point foot{0, legs_[side].side_m, 0};
    if (step < 0) return foot;
    if (Moves(step) != which) {
      foot.x = Landing(step - 1);
      return foot;
    }
    const double way = std::clamp(part, 0.0, 1.0), lifted = coopdyn_sin(coopdyn_acos(-1) * way);
    foot.x = Landing(step - 2) + Smooth(way) * (Landing(step) - Landing(step - 2));
    foot.z = lift_m_ * lifted * lifted;
    return foot;
  }

  /// The standing foot in that step.
  Point Support(double step) const {
    if (step < 0) return {};
    if (step >= steps_) return {Landing(steps_ - 1), 0, 0};
    return {Landing(step - 1), legs_[Moves(step) == 1 ? 0 : 1].side_m, 0};
  }

  Point Zmp(double time_s) const {
    const double since = (time_s - wait_s_) / period_s_, step = std::floor(since);
    return Between(Support(step - 1), Support(step), std::min(1.0, (since - step) / kBothStand));
  }

  Point CentreOfMass(double time_s) const {
    Point sum;
    double weights = 0;
    for (double away_s = -kSight_s; away_s <= kSight_s; away_s += kSlice_s) {
      const double weight = coopdyn_exp(-kOmega_1_s * std::abs(away_s));
      const Point zmp = Zmp(time_s + away_s);
      sum.x += weight * zmp.x;
      sum.y += weight * zmp.y;
      weights += weight;
    }
    return {sum.x / weights, sum.y / weights, 0};
  }

  /// Sets a leg's joints so that its hip is at `hip` from the ankle, with level pelvis and foot.
  static void Place(const Leg& leg, const Point& hip, coopdyn_setpoint* setpoints) {
    const double upright = coopdyn_hypot(hip.y, hip.z), length = coopdyn_hypot(hip.x, upright);
    const double bent = (length * length - leg.thigh_m * leg.thigh_m - leg.shank_m * leg.shank_m) /
                        (2 * leg.thigh_m * leg.shank_m);
    const double knee = coopdyn_acos(std::clamp(bent, -1.0, 1.0));
    const double ankle_roll = coopdyn_atan2(hip.y, hip.z);
    const double ankle_pitch =
        coopdyn_atan2(-leg.thigh_m * coopdyn_sin(knee), leg.shank_m + leg.thigh_m * coopdyn_cos(knee)) -
        coopdyn_atan2(hip.x, upright);
    // The thigh's orientation: Rx(−ankle roll) Ry(lean) = Ry(hip pitch) Rx(hip roll) Rz(hip yaw).
    const double lean = -(ankle_pitch + knee);
    const double s = coopdyn_sin(ankle_roll), c = coopdyn_cos(ankle_roll);
    const auto set = [setpoints](size_t joint, double angle_rad) {
      setpoints[joint] = {COOPDYN_DIRECT, angle_rad};
    };
    set(leg.hip_pitch, coopdyn_atan2(coopdyn_sin(lean), c * coopdyn_cos(lean)));
    set(leg.hip_roll, -coopdyn_asin(s * coopdyn_cos(lean)));
    set(leg.hip_yaw, coopdyn_atan2(-s * coopdyn_sin(lean), c));
    set(leg.knee, knee);
    set(leg.ankle_pitch, ankle_pitch);
    set(leg.ankle_roll, ankle_roll);
  }

  /// The ankle angle against a lean.
  double Lean(double angle_rad, double rate_rad_s) const {
    constexpr double kAhead_s = 0.1, kMost_rad = 0.1;
    return std::clamp(balance_ * (angle_rad + kAhead_s * rate_rad_s), -kMost_rad, kMost_rad);
  }

  size_t Find(const std::string& joint) const {
    for (size_t i = 0; i < robot_.channel_count; ++i) {
      if (joint == robot_.channels[i].name && (robot_.channels[i].modes >> COOPDYN_DIRECT & 1) != 0) return i;
    }
    throw std::runtime_error("the robot has no driven joint " + joint);
  }

  const coopdyn_robot& robot_;
  const double length_m_, period_s_, lift_m_, wait_s_, steps_, balance_;
  std::array<Leg, 2> legs_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Walk>();
}
