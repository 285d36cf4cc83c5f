// SPDX-License-Identifier: MIT
// The steps of what touches nothing and is held by no motor. Nothing takes its energy away, so an error of
// the method would stay in it and grow: limp chains would explode.
//
// A step is time-symmetric: half the way at the old rates, the forces where that ends, half the way at the
// new rates. It has parts where one would be too coarse. What energy is too much or missing in the end, by
// the work of what acts on the joints, goes out of or into the motion of the bodies against each other: E.
// Hairer, C. Lubich, G. Wanner (2006), Geometric Numerical Integration, section IV.4 (projection methods).
#include <algorithm>
#include <cmath>

#include "server/physics/limb_solver.h"

namespace coopdyn {

namespace {

constexpr int kUsualParts = 8, kMostParts = 128;
constexpr double kSwing_rad = 2;   // in a part, of the fastest swing: at 2 the method gets unstable
constexpr double kTurn_rad = 0.1;  // in a part, of what turns about any axis
constexpr double kLost = 0.05;     // of the kinetic energy, in a step

}  // namespace

bool LimbSolver::Fly(double dt_s) {
  const double before_j = forest_.Energy_j(settings_.gravity_m_s2);
  const double turn_rad = forest_.FreeTurnRate_rad_s() * dt_s;
  int parts = 1;
  while (parts < kMostParts && turn_rad > kTurn_rad * parts) parts *= 2;
  for (const int first = parts;; parts *= 2) {
    if (parts > first) {
      forest_.Clear();
      for (const Member& member : members_) forest_.Add(*member.mechanism, member.bodies);
    }
    const double most_swing_rad = parts < kUsualParts ? kSwing_rad : kInfinity;
    const std::optional<Flight> flight = FlyParts(parts, dt_s / parts, most_swing_rad);
    if (!flight) continue;
    const double gained_j = forest_.Energy_j(settings_.gravity_m_s2) - before_j - flight->work_j;
    if (!std::isfinite(gained_j)) return false;
    if (parts < kUsualParts && std::abs(gained_j) > kLost * forest_.Energy_j(0)) continue;
    if (parts < kMostParts && forest_.IsViolent()) continue;
    if (flight->is_solved) forest_.Slow(gained_j, rates_);
    return flight->is_solved;
  }
}

std::optional<LimbSolver::Flight> LimbSolver::FlyParts(int parts, double dt_s, double most_swing_rad) {
  Flight flight;
  std::ranges::fill(efforts_, 0.0);
  rates_ = forest_.rates();
  for (int i = 0; i < parts; ++i) {
    const std::vector<double> before = rates_;
    forest_.Move(before, i == 0 ? dt_s / 2 : dt_s);
    forest_.Continue(before);
    motors_.clear();
    rows_.clear();
    jacobian_.clear();
    std::ranges::fill(pushes_, 0.0);
    for (const Member& member : members_) DriveJoints(member, member.rows, dt_s);
    flight.is_solved &= FindRates(dt_s);
    if (forest_.SwingRate_rad_s() * dt_s > most_swing_rad) return std::nullopt;
    AddEfforts();
    flight.work_j += WorkSince(before);
  }
  forest_.Move(rates_, dt_s / 2);
  return flight;
}

double LimbSolver::WorkSince(std::span<const double> before) const {
  const auto mean = [&](std::size_t dof) { return (before[dof] + rates_[dof]) / 2; };
  double work_j = 0;
  for (std::size_t dof = 0; dof < pushes_.size(); ++dof) work_j += pushes_[dof] * mean(dof);
  for (const Motor& motor : motors_) work_j += motor.applied * mean(static_cast<std::size_t>(motor.dof));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double rate = (RateOf(rows_[i], before) + RateOf(rows_[i], rates_)) / 2;
    work_j += impulses_[static_cast<Eigen::Index>(i)] * rate;
  }
  return work_j;
}

}  // namespace coopdyn
