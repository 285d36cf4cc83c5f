// SPDX-License-Identifier: MIT
// Steps of things that touch nothing and are held by no motor. Nothing dissipates their energy, so
// integration errors would accumulate, and limp chains would explode.
//
// A step is time-symmetric: half the motion at the old rates, the forces there, half the motion at the new
// rates. It is split into parts if one would be too coarse. The energy error at the end, given the work on
// the joints, is removed from the relative motion of the bodies: E. Hairer, C. Lubich, G. Wanner (2006),
// Geometric Numerical Integration, section IV.4 (projection methods).
#include <algorithm>
#include <cmath>

#include "server/physics/limb_solver.h"

namespace coopdyn {

namespace {

constexpr int kUsualParts = 8, kMostParts = 128;
constexpr double kSwing_rad = 2;           // per part, of the fastest swing: at 2 the method becomes unstable
constexpr double kPartNutation_rad = 0.5;  // per part, of a rotor's axle
constexpr double kTurn_rad = 0.1;          // per part, of floating bodies and ball joints
// Energy errors, as shares of the kinetic energy, beyond which a step gets up to kUsualParts or kMostParts.
constexpr double kLost = 0.05, kMostLost = 0.5;

}  // namespace

bool LimbSolver::FliesExactly() const {
  if (members_.size() != 1 || !members_.front().mechanism->is_loose()) return false;
  const Matrix3& I = members_.front().mechanism->bodies.front().inertia_kg_m2;
  return I == I(0, 0) * Matrix3::Identity();
}

bool LimbSolver::Fly(double dt_s) {
  if (FliesExactly()) {
    std::ranges::fill(efforts_, 0.0);
    rates_ = forest_.rates();
    forest_.Move(rates_, dt_s / 2);
    for (std::size_t i = 0; i < 3; ++i) rates_[3 + i] += dt_s * settings_.g_W[static_cast<Eigen::Index>(i)];
    forest_.Move(rates_, dt_s / 2);
    forest_.SetRates(rates_);
    return true;
  }
  const double before_j = forest_.EnergyAt(settings_.g_W).total_j();
  const double turn_rad = forest_.FreeTurnRate_rad_s() * dt_s;
  int parts = 1;
  while (parts < kMostParts && turn_rad > kTurn_rad * parts) parts *= 2;
  forest_.Save();
  for (const int first = parts;;) {
    if (parts > first) forest_.Return();
    const double most = parts < kUsualParts ? 1 : kInfinity;
    const Flight flight = FlyParts(parts, dt_s / parts, most);
    if (flight.coarseness > most) {
      const double wanted = std::ceil(parts * flight.coarseness);
      parts = std::max(parts + 1, static_cast<int>(std::min<double>(wanted, kUsualParts)));
      continue;
    }
    const Forest::Energy after = forest_.EnergyAt(settings_.g_W);
    const double gained_j = after.total_j() - before_j - flight.work_j;
    if (!std::isfinite(gained_j)) return false;
    const double share = std::abs(gained_j) / after.kinetic_j;
    if ((parts < kUsualParts && share > kLost) ||
        (parts < kMostParts && (share > kMostLost || forest_.IsViolent()))) {
      parts *= 2;
      continue;
    }
    if (flight.is_solved) forest_.Slow(gained_j, after.kinetic_j, rates_);
    return flight.is_solved;
  }
}

LimbSolver::Flight LimbSolver::FlyParts(int parts, double dt_s, double most) {
  Flight flight;
  std::ranges::fill(efforts_, 0.0);
  rates_ = forest_.rates();
  for (int i = 0; i < parts; ++i) {
    forest_.Move(rates_, i == 0 ? dt_s / 2 : dt_s);
    forest_.Continue(rates_);
    motors_.clear();
    rows_.clear();
    jacobian_.clear();
    std::ranges::fill(pushes_, 0.0);
    for (const Member& member : members_) DriveJoints(member, member.rows, dt_s);
    BeginStep(dt_s);
    const auto is_too_coarse = [&] {
      flight.coarseness = std::max({flight.coarseness, forest_.SwingRate_rad_s() * dt_s / kSwing_rad,
                                    nutation_rad_ / kPartNutation_rad});
      return flight.coarseness > most;
    };
    nutation_rad_ = 0;
    if (is_too_coarse()) return flight;  // at the old rates; below, at the mean of old and new rates
    flight.is_solved &= FindRates(dt_s);
    if (is_too_coarse()) return flight;
    AddEfforts();
    const Work work = WorkSince(forest_.rates());
    flight.work_j += work.motors_j + work.rows_j;
  }
  forest_.Move(rates_, dt_s / 2);
  forest_.SetRates(rates_);
  return flight;
}

LimbSolver::Work LimbSolver::WorkSince(std::span<const double> before) const {
  const auto mean = [&](std::size_t dof) { return (before[dof] + rates_[dof]) / 2; };
  Work work;
  for (std::size_t dof = 0; dof < pushes_.size(); ++dof) work.motors_j += pushes_[dof] * mean(dof);
  for (const Motor& motor : motors_)
    work.motors_j += motor.applied * mean(static_cast<std::size_t>(motor.dof));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double rate = (RateOf(rows_[i], before) + RateOf(rows_[i], rates_)) / 2;
    const bool is_spring = rows_[i].resistance.stiffness + rows_[i].resistance.damping > 0;
    (is_spring ? work.motors_j : work.rows_j) += impulses_[static_cast<Eigen::Index>(i)] * rate;
  }
  return work;
}

}  // namespace coopdyn
