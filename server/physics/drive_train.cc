// SPDX-License-Identifier: MIT
#include "server/physics/drive_train.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace coopdyn {

namespace {

// Faster than any joint turns, slow enough that a line through here is exact to 1e-11 rad/s.
constexpr double kFar_rad_s = 1e5;

double MotorAt(const MotorLaw& law, double rate) {
  const double most = law.torque - law.slope * rate;
  if (!law.is_servo) return most;
  const double wanted = std::clamp((law.target - rate) / law.softness, -law.most, law.most);
  return std::clamp(wanted, -law.torque - law.slope * rate, most);
}

/// Corners of the motor's torque line, by decreasing rate.
std::vector<RotorPoint> MotorCorners(const MotorLaw& law) {
  std::vector<RotorPoint> corners;
  if (!law.is_servo) {
    for (const double rate : {kFar_rad_s, -kFar_rad_s}) corners.push_back({0, rate, MotorAt(law, rate)});
    return corners;
  }
  std::vector<double> rates = {kFar_rad_s, -kFar_rad_s, law.target};
  const auto add = [&rates](double rate) {
    if (std::abs(rate) < kFar_rad_s) rates.push_back(rate);
  };
  for (const double sign : {-1.0, 1.0}) {
    add(law.target + sign * law.softness * law.most);
    add((sign * law.softness * law.torque - law.target) / (law.softness * law.slope - 1));
    if (law.slope <= 0) continue;
    for (const double most : {-law.most, law.most}) add((sign * law.torque - most) / law.slope);
  }
  std::ranges::sort(rates, std::greater());
  rates.erase(std::ranges::unique(rates).begin(), rates.end());
  for (const double rate : rates) {
    if (law.softness > 0) {
      corners.push_back({0, rate, MotorAt(law, rate)});
      continue;
    }
    // A rigid servo gives its full torque on either side of its target.
    MotorLaw push = law;
    push.softness = 1;
    for (const double side : {-1.0, 1.0}) {
      if (side * (law.target - rate) < 0) continue;
      push.target = rate + side * 2 * (law.most + 1);
      corners.push_back({0, rate, MotorAt(push, rate)});
    }
  }
  return corners;
}

RotorPoint Between(const RotorPoint& a, const RotorPoint& b, double share) {
  return {a.effort + share * (b.effort - a.effort), a.rate + share * (b.rate - a.rate),
          a.motor + share * (b.motor - a.motor)};
}

/// Inserts corners where `value` crosses `level`.
void Insert(std::vector<RotorPoint>& line, double RotorPoint::*value, double level) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const double from = line[i].*value - level, to = line[i + 1].*value - level;
    if ((from < 0) == (to < 0) || from == 0 || to == 0) continue;
    RotorPoint corner = Between(line[i], line[i + 1], from / (from - to));
    corner.*value = level;
    line.insert(line.begin() + static_cast<std::ptrdiff_t>(i) + 1, corner);
    ++i;
  }
}

/// Computes the rotor's rate at the substep's end for each torque of the coupling.
void RotorLine(const DriveTrainModel& train, const MotorLaw& law, double rate, double dt_s,
               std::vector<RotorPoint>& line) {
  const double inertia = train.ratio * train.ratio * train.rotor_inertia_kg_m2;
  line = MotorCorners(law);
  for (RotorPoint& point : line) point.effort = point.motor - inertia * (point.rate - rate) / dt_s;
  if (train.efficiency >= 1) return;
  // The gear loses a share of the transmitted torque in both directions, so a standing rotor holds a range of
  // torques.
  Insert(line, &RotorPoint::effort, 0);
  Insert(line, &RotorPoint::rate, 0);
  std::vector<RotorPoint> lossy;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const RotorPoint& point = line[i];
    const auto add = [&](bool drives) {
      lossy.push_back(point);
      lossy.back().effort *= drives ? train.efficiency : 1 / train.efficiency;
    };
    if (point.rate >= 0) add(point.effort > 0);
    if (point.rate <= 0) add(point.effort < 0);
  }
  line = std::move(lossy);
}

/// Weight of the force at the step's end: 0 up to `from`, 1 from `to` on. `value`: the square of a swing's
/// angle per step, or the share of the rate that a damper removes per step.
double EndShare(double from, double to, double value) {
  return std::clamp((value - from) / (to - from), 0.0, 1.0);
}

/// The coupling. JointRate() is the joint's rate at which the coupling passes on `effort` while the rotor
/// turns at `rate`. `side`: the sign of the torque.
class Coupling {
 public:
  /// `twist_rate`: at the step's beginning; `give`: sum of both inverse inertias, 1 / (kg m²).
  Coupling(const DriveTrainModel& train, double twist, double twist_rate, double give, double dt_s)
      : train_(train), twist_(twist), dt_s_(dt_s) {
    if (train.is_rigid()) return;
    const double end = EndShare(1, 4, dt_s * dt_s * train.stiffness_nm_rad * give),
                 damping_end = EndShare(1, 2, dt_s * train.damping_nms_rad * give);
    per_step_ = (1 + 3 * end) / 4 * dt_s * train.stiffness_nm_rad;
    damping_ = (1 + damping_end) / 2 * train.damping_nms_rad;
    spring_before_ = -(1 - end) / 4 * dt_s * train.stiffness_nm_rad * twist_rate;
    damping_before_ = (1 - damping_end) / 2 * train.damping_nms_rad * twist_rate;
  }

  bool has_gap() const { return train_.backlash_rad > 0; }
  double preload() const { return train_.is_rigid() ? 0 : train_.preload_nm; }

  double JointRate(double effort, double rate, double side, bool beyond_preload) const {
    const double bent = twist_ - side * train_.backlash_rad / 2;
    if (train_.is_rigid() || (preload() > 0 && !beyond_preload)) return rate + bent / dt_s_;
    // The damper acts while the faces touch, or always if there is no gap and no preload.
    const bool damps = (!has_gap() && preload() == 0) || side * bent > 0;
    const double resistance = per_step_ + (damps ? damping_ : 0);
    const double before = train_.stiffness_nm_rad * bent + spring_before_ + (damps ? damping_before_ : 0);
    return rate - (effort - side * preload() - before) / resistance;
  }

 private:
  const DriveTrainModel& train_;
  const double twist_, dt_s_;
  // Decrease of the effort with the joint's rate, and effort due to the rate before the step.
  double per_step_ = 0, damping_ = 0, spring_before_ = 0, damping_before_ = 0;
};

}  // namespace

MotorLaw LawOf(const DriveTrainModel& train, const Setpoint& setpoint, const JointRow& servo) {
  MotorLaw law;
  if (setpoint.mode == ControlMode::kIdle) return law;
  const bool is_duty = setpoint.mode == ControlMode::kPwm;
  const double duty = is_duty ? std::abs(setpoint.reference) : 1;
  const PwmRow row = RowAt(train, duty > 0 ? duty : 1);
  law.stall_current_a = row.stall_current_a;
  law.stall_torque_nm = row.stall_torque_nm;
  law.slope_nms_rad = row.no_load_speed_rad_s > 0 ? row.stall_torque_nm / row.no_load_speed_rad_s : 0;
  if (is_duty && duty <= 0) {
    law.slope_nms_rad = train.brake_nms_rad;
    law.draws = false;
  }
  law.slope = train.ratio * train.ratio * law.slope_nms_rad;
  if (is_duty) {
    law.torque = duty > 0 ? std::copysign(train.ratio * row.stall_torque_nm, setpoint.reference) : 0;
    return law;
  }
  law.is_servo = true;
  law.torque = train.ratio * row.stall_torque_nm;
  law.target = std::clamp(servo.velocity, -kFar_rad_s, kFar_rad_s);
  law.softness = servo.softness;
  law.most = std::min(servo.max_effort, 2 * (law.torque + law.slope * kFar_rad_s));
  return law;
}

void PlanTrain(const DriveTrainModel& train, const DriveTrainState& state, const JointPlace& place,
               double inertia_kg_m2, double dt_s, TrainStep& step) {
  std::vector<RotorPoint>& line = step.rotor;
  RotorLine(train, step.law, state.rotor_rad_s, dt_s, line);
  const double rotor_kg_m2 = train.ratio * train.ratio * train.rotor_inertia_kg_m2;
  const Coupling coupling(train, state.rotor_rad - place.position, state.rotor_rad_s - place.velocity,
                          1 / rotor_kg_m2 + 1 / inertia_kg_m2, dt_s);
  const double preload = coupling.preload();
  if (coupling.has_gap() || preload > 0) Insert(line, &RotorPoint::effort, 0);
  if (preload > 0) {
    for (const double side : {-1.0, 1.0}) Insert(line, &RotorPoint::effort, side * preload);
  }
  step.shares.clear();
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const RotorPoint &low = line[i], &high = line[i + 1];
    if (!(high.effort > low.effort)) continue;
    const double middle = (low.effort + high.effort) / 2, side = middle < 0 ? -1 : 1;
    const bool beyond = std::abs(middle) > preload;
    const double fast = coupling.JointRate(low.effort, low.rate, side, beyond),
                 slow = coupling.JointRate(high.effort, high.rate, side, beyond);
    CouplingShare share;
    share.softness = std::max(0.0, (fast - slow) / (high.effort - low.effort));
    if (low.effort >= 0) {
      share.target = fast;
      share.upper = high.effort - low.effort;
    } else if (high.effort <= 0) {
      share.target = slow;
      share.lower = low.effort - high.effort;
    } else {
      share.target = fast + share.softness * low.effort;
      share.lower = low.effort;
      share.upper = high.effort;
    }
    if (i == 0) share.lower = -JointModel::kInfinity;
    if (i + 2 == line.size()) share.upper = JointModel::kInfinity;
    step.shares.push_back(share);
  }
}

void AdvanceTrain(const DriveTrainModel& train, const TrainStep& step, double effort, double dt_s,
                  DriveTrainState& state) {
  const auto above =
      std::ranges::find_if(step.rotor.begin() + 1, step.rotor.end() - 1,
                           [effort](const RotorPoint& point) { return point.effort >= effort; });
  const RotorPoint &low = *(above - 1), &high = *above;
  const double span = high.effort - low.effort;
  const RotorPoint now = Between(low, high, span > 0 ? (effort - low.effort) / span : 0);
  const MotorLaw& law = step.law;
  const double torque_nm = now.motor / train.ratio, shaft_rad_s = now.rate * train.ratio;
  state.rotor_rad += dt_s * now.rate;
  state.rotor_rad_s = now.rate;
  state.current_a = law.stall_torque_nm > 0 ? torque_nm / law.stall_torque_nm * law.stall_current_a : 0;
  if (!law.draws || law.slope_nms_rad <= 0) return;
  // Voltage is proportional to the no-load speed at this duty, current to torque: power = speed · torque.
  state.energy_j += dt_s * std::max(0.0, torque_nm * (shaft_rad_s + torque_nm / law.slope_nms_rad));
}

double FrictionOf(const DriveTrainModel& train, double rate) {
  return std::abs(rate) < train.stiction_speed_rad_s ? train.static_friction_nm : train.dynamic_friction_nm;
}

}  // namespace coopdyn
