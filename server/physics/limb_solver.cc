// SPDX-License-Identifier: MIT
#include "server/physics/limb_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "server/physics/rest.h"

namespace coopdyn {

namespace {

// Problems with more rows are solved by iteration.
constexpr std::size_t kMaxRows = 150;
constexpr int kIterations = 80;
// Largest softness of friction across a slip, times the row's mobility; any softer, it has no effect.
constexpr double kSoftest = 1e6;
// Largest number of rounds per step in which motors switch between holding and saturated.
constexpr int kMotorRounds = 12;
// With contacts, the step's mean forces matter if they change a rate by more than this: rad/s, m/s.
constexpr double kMattersInContact = 0.1;
// If a body turns farther than kFast_rad in a step, the solver checks the energy: integration errors may add
// at most kMostGain of the kinetic energy.
constexpr double kFast_rad = 0.1, kMostGain = 0.01;
// A rotor matters if it spins, and its axle nutates, by more than this in a step.
constexpr double kSpin_rad = 0.1, kNutation_rad = 0.05;

}  // namespace

LimbSolver::LimbSolver(const Things& things, const WorldSettings& settings)
    : things_(things), settings_(settings) {
  Fit();
}

void LimbSolver::Load(std::uint32_t thing, const Actor& actor, std::span<const ChannelState> channels,
                      std::span<const JointRow> rows, double dt_s) {
  const Mechanism& mechanism = *actor.thing.mechanism;
  member_of_[thing] = static_cast<int>(members_.size());
  loaded_.push_back(thing);
  Member& member = members_.emplace_back();
  member.mechanism = &mechanism;
  member.first_node = forest_.Add(mechanism, {actor.bodies, mechanism.bodies.size()});
  member.first_effort = efforts_.size();
  member.channels = channels;
  member.rows = rows;
  efforts_.resize(efforts_.size() + mechanism.joints.size());
  pushes_.resize(static_cast<std::size_t>(forest_.dof_count()));
  step_s_ = dt_s;
  DriveJoints(member, rows, dt_s);
}

void LimbSolver::Unload() {
  for (const std::uint32_t thing : loaded_) member_of_[thing] = kNone;
  loaded_.clear();
  members_.clear();
  forest_.Clear();
  motors_.clear();
  rows_.clear();
  touches_ = holds_ = flies_ = false;
  measured_.clear();
  rubbing_.clear();
  turning_.clear();
  jacobian_.clear();
  pushes_.clear();
  efforts_.clear();
}

int LimbSolver::NodeOf(std::uint32_t thing, const Part& part) const {
  if (thing >= member_of_.size() || member_of_[thing] == kNone) return kNone;
  const Member& member = members_[static_cast<std::size_t>(member_of_[thing])];
  const int node = member.first_node + member.mechanism->tree.node_of[static_cast<std::size_t>(part.body)];
  return forest_.EndOf(node) == kNone ? kNone : node;
}

LimbSolver::Outcome LimbSolver::Step(double dt_s) {
  flies_ = !touches_ && !holds_;
  const bool is_solved = flies_ ? Fly(dt_s) : Advance(dt_s);
  if (!std::isfinite(std::accumulate(rates_.begin(), rates_.end(), 0.0))) return Outcome::kInsane;
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    for (std::size_t k = 0; k < rubbing_[i].count; ++k) {
      const double impulse = impulses_[static_cast<Eigen::Index>(rubbing_[i].first_row + k)];
      measured_[i].force_W += impulse / dt_s * rubbing_[i].directions[k];
    }
  }
  return is_solved ? Outcome::kSolved : Outcome::kNear;
}

bool LimbSolver::Advance(double dt_s) {
  const bool is_fast = forest_.TurnRate_rad_s() * dt_s > kFast_rad;
  const Forest::Energy before = is_fast ? forest_.EnergyAt(settings_.g_W) : Forest::Energy();
  BeginStep(dt_s);
  const bool is_solved = FindRates(dt_s);
  AddEfforts();
  forest_.Move(rates_, dt_s);
  forest_.SetRates(rates_);
  if (is_fast) LimitGain(before);
  // A light hand that hits the floor would get a turn rate that no hand has.
  constexpr double kMostTurn_rad_s = 900;
  const double turn_rad_s = forest_.TurnRate_rad_s();
  if (turn_rad_s > kMostTurn_rad_s) forest_.SlowJoints(kMostTurn_rad_s / turn_rad_s, rates_);
  return is_solved;
}

void LimbSolver::LimitGain(const Forest::Energy& before) {
  const Forest::Energy after = forest_.EnergyAt(settings_.g_W);
  const Work work = WorkSince(forest_.rates());
  // Contacts add no energy: positive work of rows is an integration error, too.
  const double gained_j = after.total_j() - before.total_j() - work.motors_j - std::min(0.0, work.rows_j);
  const double most_j = kMostGain * std::min(before.kinetic_j, after.kinetic_j);
  if (gained_j > most_j && !touches_) forest_.Slow(gained_j - most_j, after.kinetic_j, rates_);
  if (gained_j > most_j && touches_) {
    const double scale = std::sqrt(std::max(0.0, 1 - (gained_j - most_j) / after.kinetic_j));
    for (double& rate : rates_) rate *= scale;
    forest_.SetRates(rates_);
  }
}

void LimbSolver::BeginStep(double dt_s) {
  for (const Member& member : members_) {
    for (const int joint : member.mechanism->tree.loops) CloseLoop(member, joint, dt_s);
    Couple(member, dt_s);
  }
  forest_.Begin(settings_.g_W, dt_s);
  if (!motors_.empty() || !rows_.empty()) forest_.ComputeMasses();
  FitSprings(dt_s);
}

bool LimbSolver::FindRates(double dt_s) {
  if (!Settle(false)) return false;
  nutation_rad_ = forest_.NutationRate_rad_s(kSpin_rad / dt_s) * dt_s;
  if (nutation_rad_ < kNutation_rad) nutation_rad_ = 0;
  if (!UseMeanForces()) return true;
  return Settle(true) && (nutation_rad_ == 0 || SettleRotors());
}

// The mean m of the rates before and after the step is g(m), given the forces at m. Near it, g turns by a
// right angle and scales by half the nutation, so repeating m = g(m) would swing, or grow. The two-step
// Chebyshev iteration for such spectra, mₖ₊₁ = mₖ₋₁ + weight · (g(mₖ) − mₖ₋₁), converges for any scale up to
// `scale`: T. A. Manteuffel (1977), The Tchebychev iteration for nonsymmetric linear systems.
bool LimbSolver::SettleRotors() {
  constexpr double kMargin = 1.5;  // several rotors may act together
  constexpr double kNegligible = 1e-6;
  constexpr int kMostRounds = 100;
  const double scale = kMargin * nutation_rad_ / 2, root = 1 + std::sqrt(1 + scale * scale);
  const double weight = 2 / root, shrink = scale / root;
  const std::vector<double>& before = forest_.rates();
  earlier_ = before;
  double error = shrink;
  for (int round = 0; round < kMostRounds && error > kNegligible; ++round, error *= shrink) {
    for (std::size_t dof = 0; dof < mean_.size(); ++dof) {
      const double next = earlier_[dof] + weight * ((before[dof] + rates_[dof]) / 2 - earlier_[dof]);
      if (!std::isfinite(next)) return false;
      earlier_[dof] = std::exchange(mean_[dof], next);
    }
    forest_.EvaluateForcesAt(mean_);
    if (!Settle(true)) return false;
  }
  return true;
}

void LimbSolver::AddEfforts() {
  for (const Motor& motor : motors_) {
    if (motor.effort != kNowhere) efforts_[motor.effort] += motor.applied / step_s_;
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].effort == kNone) continue;
    efforts_[static_cast<std::size_t>(rows_[i].effort)] += impulses_[static_cast<Eigen::Index>(i)] / step_s_;
  }
}

bool LimbSolver::Settle(bool is_again) {
  for (int round = 0; round < kMotorRounds; ++round) {
    const bool is_solved = Solve(is_again || round > 0, is_again && round == 0);
    rates_ = state_;
    forest_.Finish(rates_);
    if (!SwitchMotors(round < kMotorRounds / 2)) return is_solved;
  }
  return false;
}

bool LimbSolver::UseMeanForces() {
  const std::vector<double>& before = forest_.rates();
  mean_.resize(rates_.size());
  for (std::size_t dof = 0; dof < mean_.size(); ++dof) {
    mean_[dof] = (before[dof] + rates_[dof]) / 2;
    if (!std::isfinite(mean_[dof])) return false;
  }
  momentum_ = forest_.momentum();
  forest_.EvaluateForcesAt(mean_);
  const double matters = touches_ && nutation_rad_ == 0 ? kMattersInContact : 0;
  for (int dof = 0; dof < forest_.dof_count(); ++dof) {
    const auto d = static_cast<std::size_t>(dof);
    const double least = matters > 0 ? matters * forest_.MassOf(dof) : 0;
    if (std::abs(forest_.momentum()[d] - momentum_[d]) > least) return true;
  }
  return false;
}

// A spring's force is evaluated at q + dt/4 (v' − v), with v and v' the rates before and after the step, so
// that it conserves energy, with the period of the trapezoidal rule; a damper's at the mean of the rates. A
// joint that swings or slows within a few steps would ring forever: there the force changes over to that of
// the step's end.
void LimbSolver::FitSprings(double dt_s) {
  const auto fit = [dt_s](auto& of, double mass, double yielding_mass, double rate) {
    const auto [stiffness, damping] = of.resistance;
    const double per_step = dt_s * stiffness, whole = per_step + damping;
    const double swing = dt_s * per_step / mass;               // (ω dt)²
    const double end = std::clamp((swing - 1) / 3, 0.0, 1.0);  // from ω dt = 1 to 2
    const double damping_end = std::clamp(dt_s * damping / yielding_mass - 1, 0.0, 1.0);
    const double early = (1 - end) * per_step / 4, mean = (1 - damping_end) * damping / 2;
    const double resistance = whole - 3 * early - mean;
    of.target = (of.target * whole + (early - mean) * rate) / resistance;
    of.softness = 1 / (resistance * dt_s) + kRigid;
  };
  const auto resists = [](const auto& of) { return of.resistance.stiffness + of.resistance.damping > 0; };
  const bool any_row = std::ranges::any_of(rows_, resists);
  if (!any_row && std::ranges::none_of(motors_, resists)) return;
  // A damper slows the articulated inertia: bodies on limp joints do not follow at once.
  added_.assign(static_cast<std::size_t>(forest_.dof_count()), 0);
  forest_.Factor(added_);
  for (Motor& motor : motors_) {
    if (!resists(motor)) continue;
    const double rate = forest_.rates()[static_cast<std::size_t>(motor.dof)];
    fit(motor, forest_.MassOf(motor.dof), forest_.pivot(motor.dof), rate);
  }
  for (Row& row : rows_) {
    if (!resists(row)) continue;
    double give = 0, yielding_give = 0;  // 1 / mass
    for (const Row::Part& part : row.all()) {
      const double* J = jacobian_.data() + part.from;
      for (const int dof : forest_.Chain(part.end)) {
        const double square = *J * *J;
        give += square / forest_.MassOf(dof);
        yielding_give += square / forest_.pivot(dof);
        ++J;
      }
    }
    fit(row, 1 / give, 1 / yielding_give, RateOf(row, forest_.rates()));
  }
}

bool LimbSolver::SwitchMotors(bool may_release) {
  bool switched = false;
  for (Motor& motor : motors_) {
    const double missing = motor.target - rates_[static_cast<std::size_t>(motor.dof)];
    motor.applied = motor.saturated_side != 0 ? motor.bound() : missing / motor.softness;
    if (motor.lower == -kInfinity && motor.upper == kInfinity) continue;
    constexpr double kSlack = 1e-12;  // rounding
    if (motor.saturated_side == 0) {
      if (missing > motor.softness * motor.upper + kSlack) {
        motor.saturated_side = 1;
      } else if (missing < motor.softness * motor.lower - kSlack) {
        motor.saturated_side = -1;
      }
      switched |= motor.saturated_side != 0;
    } else if (may_release && (motor.saturated_side > 0 ? missing < motor.softness * motor.upper - kSlack
                                                        : missing > motor.softness * motor.lower + kSlack)) {
      motor.saturated_side = 0;
      switched = true;
    }
  }
  return switched;
}

bool LimbSolver::Solve(bool is_again, bool same_motors) {
  added_.assign(static_cast<std::size_t>(forest_.dof_count()), 0);
  state_ = forest_.momentum();
  for (std::size_t dof = 0; dof < state_.size(); ++dof) state_[dof] += pushes_[dof];
  for (const Motor& motor : motors_) {
    const auto dof = static_cast<std::size_t>(motor.dof);
    if (motor.saturated_side == 0) {
      added_[dof] += 1 / motor.softness;
      state_[dof] += motor.target / motor.softness;
    } else {
      state_[dof] += motor.bound();
    }
  }
  if (!same_motors) Factor();
  forest_.Transform(state_);
  if (!is_again) {
    impulses_.setZero(static_cast<Eigen::Index>(rows_.size()));
    lcp_.Forget();
  }
  if (rows_.empty()) return true;
  if (rows_.size() <= kMaxRows) return SolveDirectly(is_again, same_motors);
  SolveByIteration();
  return true;
}

void LimbSolver::Factor() {
  forest_.Factor(added_);
  transformed_ = jacobian_;
  divided_.resize(jacobian_.size());
  for (const Row& row : rows_) {
    for (const Row::Part& part : row.all()) {
      const auto length = static_cast<std::size_t>(forest_.ChainLength(part.end));
      const std::span<double> values = std::span(transformed_).subspan(part.from, length);
      forest_.Transform(part.end, values);
      const std::span<const int> chain = forest_.Chain(part.end);
      for (std::size_t d = 0; d < length; ++d) divided_[part.from + d] = values[d] / forest_.pivot(chain[d]);
    }
  }
}

const std::vector<double>& LimbSolver::Column(const Row& row) {
  column_.assign(static_cast<std::size_t>(forest_.dof_count()), 0);
  for (const Row::Part& part : row.all()) {
    const double* x = divided_.data() + part.from;
    for (const int dof : forest_.Chain(part.end)) column_[static_cast<std::size_t>(dof)] += *x++;
  }
  return column_;
}

double LimbSolver::Dot(const Row& row, std::span<const double> transformed) const {
  double sum = 0;
  for (const Row::Part& part : row.all()) {
    const double* x = transformed_.data() + part.from;
    for (const int dof : forest_.Chain(part.end)) sum += *x++ * transformed[static_cast<std::size_t>(dof)];
  }
  return sum;
}

void LimbSolver::Apply(const Row& row, double impulse) {
  for (const Row::Part& part : row.all()) {
    const double* x = divided_.data() + part.from;
    for (const int dof : forest_.Chain(part.end)) state_[static_cast<std::size_t>(dof)] += *x++ * impulse;
  }
}

bool LimbSolver::SolveDirectly(bool is_again, bool same_motors) {
  const auto n = static_cast<Eigen::Index>(rows_.size());
  A_.resize(n, n);
  b_.resize(n);
  lower_.resize(n);
  upper_.resize(n);
  bool rubs = false;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Row& row = rows_[static_cast<std::size_t>(i)];
    if (!same_motors) {
      const std::vector<double>& column = Column(row);
      for (Eigen::Index j = i; j < n; ++j)
        A_(i, j) = A_(j, i) = Dot(rows_[static_cast<std::size_t>(j)], column);
      A_(i, i) += row.softness;
    }
    b_[i] = row.target - Dot(row, state_);
    lower_[i] = row.normal == kNone ? row.lower : 0;
    upper_[i] = row.normal == kNone ? row.upper : 0;
    rubs |= row.normal != kNone;
  }
  // First without friction, then twice with the friction that the latest loads allow.
  bool is_solved = true;
  if (!is_again) {
    is_solved = lcp_.Solve(A_, b_, lower_, upper_, impulses_);
    TurnFriction();
  }
  for (int pass = 0; (rubs || is_again) && pass < 2; ++pass) {
    for (Eigen::Index i = 0; i < n; ++i) {
      Row& row = rows_[static_cast<std::size_t>(i)];
      if (row.normal == kNone) continue;
      upper_[i] = row.friction * std::max(0.0, impulses_[row.normal]);
      lower_[i] = -upper_[i];
      if (row.slip_m_s <= 0 || upper_[i] <= 0) continue;
      const double softness = SoftnessAcross(row.slip_m_s, upper_[i], A_(i, i) - row.softness);
      A_(i, i) += softness - row.softness;
      row.softness = softness;
    }
    is_solved = lcp_.Solve(A_, b_, lower_, upper_, impulses_);
  }
  for (Eigen::Index i = 0; i < n; ++i) Apply(rows_[static_cast<std::size_t>(i)], impulses_[i]);
  return is_solved;
}

double LimbSolver::SoftnessAcross(double slip_m_s, double most, double mobility) const {
  const double least = kCfm / step_s_;
  return std::clamp(slip_m_s / most, least, std::max(least, kSoftest * mobility));
}

// Projected Gauss-Seidel; friction rows are bounded by the present loads.
void LimbSolver::SolveByIteration() {
  std::vector<double> diagonal;
  impulses_.setZero();
  for (const Row& row : rows_) diagonal.push_back(Dot(row, Column(row)));
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Row& row = rows_[i];
      double& impulse = impulses_[static_cast<Eigen::Index>(i)];
      double lower = row.lower, upper = row.upper, softness = row.softness;
      if (row.normal != kNone) {
        upper = row.friction * std::max(0.0, impulses_[row.normal]);
        lower = -upper;
        if (row.slip_m_s > 0 && upper > 0) softness = SoftnessAcross(row.slip_m_s, upper, diagonal[i]);
      }
      const double change = (row.target - Dot(row, state_) - softness * impulse) / (diagonal[i] + softness);
      const double next = std::clamp(impulse + change, lower, upper);
      Apply(row, next - impulse);
      impulse = next;
    }
  }
}

BodyState LimbSolver::Read(std::uint32_t thing, std::size_t body) const {
  const Member& member = members_[static_cast<std::size_t>(member_of_[thing])];
  return forest_.body(member.first_node + member.mechanism->tree.node_of[body]);
}

double LimbSolver::JointEffort(std::uint32_t thing, std::size_t joint) const {
  return efforts_[members_[static_cast<std::size_t>(member_of_[thing])].first_effort + joint];
}

}  // namespace coopdyn
