// SPDX-License-Identifier: MIT
#include "server/physics/pile_solver.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/base/portable_math.h"

namespace coopdyn {

namespace {

// Distributes a load over redundant contacts: m/s per N s, for a mass of 1 kg.
constexpr double kSoftness = 5e-4;
// So much of the heaviest object's mass makes each contact at least as hard, because something light may
// carry it.
constexpr double kCarries = 1e-3;
// Rolling resistance is softer by this factor: it grows over a thousandth of a radian per second, and
// Newton's method finds its solution more often.
constexpr double kRollSoftness = 100;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Matrix3 CrossMatrix(const Vector3& r) {
  Matrix3 cross;
  cross << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return cross;
}

/// sum += [r]×.
template <typename Block>
void AddCross(const Vector3& r, Block sum) {
  sum(0, 1) -= r.z();
  sum(0, 2) += r.y();
  sum(1, 0) += r.z();
  sum(1, 2) -= r.x();
  sum(2, 0) -= r.y();
  sum(2, 1) += r.x();
}

/// sum += −k [a]× [b]×.
void AddArms(double k, const Vector3& a, const Vector3& b, Matrix3& sum) {
  const Vector3 kb = k * b;
  const double dot = a.dot(kb);
  for (int i = 0; i < 3; ++i) {
    sum.col(i) -= a[i] * kb;
    sum(i, i) += dot;
  }
}

/// sum += a bᵀ.
void AddProduct(const BlockCholesky::Vector& a, const BlockCholesky::Vector& b, BlockCholesky::Block& sum) {
  for (int i = 0; i < b.size(); ++i) sum.col(i) += b[i] * a;
}

/// A torque-free body's rates after the step: one iteration of Newton's method for the implicit step in the
/// body's axes (E. Catto (2015), "Numerical methods", GDC), which cannot gain energy.
Vector3 Spin(const Vector3& w_W, const Matrix3& R_WB, const Matrix3& I, double dt_s) {
  const Vector3 w = R_WB.transpose() * w_W;
  const Vector3 Iw = I * w;
  const Matrix3 J = I + dt_s * (CrossMatrix(w) * I - CrossMatrix(Iw));
  return R_WB * (w - J.inverse() * (dt_s * w.cross(Iw)));
}

}  // namespace

PileSolver::PileSolver(const Things& things, const WorldSettings& settings)
    : things_(things), settings_(settings) {
  Fit();
}

void PileSolver::Load(std::uint32_t thing, const Actor& actor, double dt_s) {
  const RigidBody& rigid = actor.thing.mechanism->bodies.front();
  body_of_[thing] = static_cast<int>(bodies_.size());
  loaded_.push_back(thing);
  Body& body = bodies_.emplace_back();
  body.state = actor.bodies[0];
  body.mass_kg = rigid.mass_kg;
  heaviest_kg_ = std::max(heaviest_kg_, rigid.mass_kg);
  const Matrix3 R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(body.state.R_WB.data());
  body.I_W = R * rigid.inertia_kg_m2 * R.transpose();
  body.inverse_I_W = body.I_W.inverse();
  body.v = body.free_v = body.state.v_WB;
  body.w = body.state.w_WB;
  body.free_v += settings_.g_W * dt_s;
  body.free_w = Spin(body.w, R, rigid.inertia_kg_m2, dt_s);
}

void PileSolver::Unload() {
  for (const std::uint32_t thing : loaded_) body_of_[thing] = kNone;
  loaded_.clear();
  bodies_.clear();
  heaviest_kg_ = 0;
  joints_.clear();
  points_.clear();
  measured_.clear();
  measured_points_.clear();
}

const BodyState& PileSolver::Read(std::uint32_t thing, std::size_t) const {
  return bodies_[static_cast<std::size_t>(body_of_[thing])].state;
}

// --- contacts

void PileSolver::Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a,
                      const Actor* b, std::uint32_t index_b, double dt_s, bool measured) {
  const int body_a = BodyOf(index_a), body_b = b == nullptr ? kNone : BodyOf(index_b);
  if (body_a == kNone && body_b == kNone) return;
  Joint joint{body_a, body_b, points_.size()};
  for (const FoundContact& contact : found) {
    const ContactSide of_b = b == nullptr ? ContactSide() : ContactSide{b, body_b != kNone, {}};
    const auto surface = SurfaceOf(contact, {&a, body_a != kNone, {}}, of_b, settings_, dt_s);
    if (!surface) continue;
    AddPoint(*surface, body_a, body_b, dt_s);
    if (!measured) continue;
    measured_.push_back({index_a, b == nullptr ? MeasuredContact::kFloor : index_b, contact.a, contact.b,
                         contact.point.p_W, contact.point.n_W});
    measured_points_.push_back(points_.size() - 1);
  }
  joint.count = points_.size() - joint.first;
  if (joint.count == 0) return;
  joints_.push_back(joint);
}

double PileSolver::MobilityAt(const Point& point, int a, int b) {
  double mobility = 0;
  for (const auto& [index, r] : {std::pair(a, point.r_a), std::pair(b, point.r_b)}) {
    if (index == kNone) continue;
    const Body& body = BodyAt(index);
    const Vector3 arm = r.cross(point.axes_W.col(0));
    mobility += 1 / body.mass_kg + arm.dot(body.inverse_I_W * arm);
  }
  return mobility;
}

void PileSolver::AddPoint(const Surface& surface, int a, int b, double dt_s) {
  const dContact& contact = surface.contact;
  const dSurfaceParameters& of = contact.surface;
  const auto has = [&of](int flags) { return (of.mode & flags) == flags; };
  Point& point = points_.emplace_back();
  const Vector3 normal(contact.geom.normal);
  Vector3 along;
  if (has(dContactFDir1)) {
    along = Vector3(contact.fdir1);
  } else {
    const int least = std::abs(normal.x()) < 0.6 ? 0 : 1;
    along = normal.cross(Vector3::Unit(least)).normalized();
  }
  point.axes_W.col(0) = normal;
  point.axes_W.col(1) = along;
  point.axes_W.col(2) = normal.cross(along);
  const Vector3 p_W(contact.geom.pos);
  ContactLaw& slide = point.slide;
  Vector3 approach = Vector3::Zero();
  if (a != kNone) {
    const BodyState& state = bodies_[static_cast<std::size_t>(a)].state;
    point.r_a = p_W - state.p_WB;
    approach += state.v_WB + state.w_WB.cross(point.r_a);
  }
  if (b != kNone) {
    const BodyState& state = bodies_[static_cast<std::size_t>(b)].state;
    point.r_b = p_W - state.p_WB;
    approach -= state.v_WB + state.w_WB.cross(point.r_b);
  }
  double mass_kg = 0;
  for (const int body : {a, b}) {
    if (body != kNone) mass_kg += bodies_[static_cast<std::size_t>(body)].mass_kg;
  }
  slide.hardness = std::max(mass_kg, kCarries * heaviest_kg_) / kSoftness;
  const bool yields = has(dContactSoftCFM);
  double target = (yields ? of.soft_erp : kErp) * contact.geom.depth / dt_s;
  if (has(dContactMotionN)) target += of.motionN;
  if (!yields) target = std::min(target, kMaxPushOut_m_s);
  if (has(dContactBounce)) {
    const double speed = -approach.dot(point.axes_W.col(0));
    if (speed > of.bounce_vel) {
      // Adds the speed that the softness takes away.
      const double impulse = (1 + of.bounce) * speed / MobilityAt(point, a, b);
      target = std::max(target, of.bounce * speed + (yields ? 0 : impulse / slide.hardness));
    }
  }
  slide.is_cone = true;
  slide.target[0] = target;
  // The load bounds friction by a cone; the length of the last axis makes it a round one.
  slide.friction = of.mu;
  if (surface.grain) {
    const auto [first, second] = *surface.grain;
    if (second > first) point.axes_W.col(1).swap(point.axes_W.col(2));  // the last axis may have length 0
    slide.friction = std::max(first, second);
    point.is_round = first == second;
    if (!point.is_round) point.axes_W.col(2) *= std::min(first, second) / slide.friction;
  }
  if (has(dContactRolling)) {
    point.rolls = true;
    point.roll.hardness = slide.hardness / kRollSoftness * (a != kNone ? point.r_a : point.r_b).squaredNorm();
    point.resistance = {of.rhoN, of.rho, of.rho2};
  }
  if (yields) {
    // The length of the first axis makes the contact softer along it: the impulse along the normal is that of
    // the law times this length.
    const double length = std::sqrt(dt_s / of.soft_cfm / slide.hardness);
    point.is_round = false;
    point.axes_W.col(0) *= length;
    slide.target[0] *= length;
    slide.friction *= length;
    point.resistance.tail<2>() *= length;
  }
}

// --- Newton's method

template <typename Linear, typename Angular, typename Take>
void PileSolver::AtPoints(const Linear& linear, const Angular& angular, const Take& take) {
  for (const Joint& joint : joints_) {
    const Body& a = BodyAt(joint.a);
    const Body& b = BodyAt(joint.b);
    const Vector3 between = linear(a) - linear(b), turn = angular(a) - angular(b);
    for (Point& point : PointsOf(joint)) {
      const Vector3 speed = between + angular(a).cross(point.r_a) - angular(b).cross(point.r_b);
      take(point.slide, point.axes_W.transpose() * speed);
      if (point.rolls) take(point.roll, point.axes_W.transpose() * turn);
    }
  }
}

double PileSolver::UpdateLoads(bool rolls) {
  double most = 0;
  for (Point& point : points_) {
    if (point.slide.is_cone) {
      const double slip = point.slide.Slip();
      most = std::max(most, point.slide.friction * std::abs(slip - point.slide.slip));
      point.slide.slip = slip;
    }
    if (point.rolls)
      point.roll.bound = rolls ? Vector3(point.slide.impulse[0] * point.resistance) : Vector3::Zero();
    point.slide.Push();
    if (point.rolls) point.roll.Push();
  }
  return most;
}

double PileSolver::FindGradient() {
  for (Body& body : bodies_) {
    body.gradient_v = body.mass_kg * (body.v - body.free_v);
    body.gradient_w = body.I_W * (body.w - body.free_w);
  }
  for (const Joint& joint : joints_) {
    Vector3 impulse = Vector3::Zero(), torque_a = Vector3::Zero(), torque_b = Vector3::Zero();
    for (const Point& point : PointsOf(joint)) {
      if (point.slide.state == ContactLaw::State::kOpen) continue;
      const Vector3 push = point.axes_W * point.slide.impulse;
      impulse += push;
      torque_a += point.r_a.cross(push);
      torque_b += point.r_b.cross(push);
      if (!point.rolls) continue;
      const Vector3 twist = point.axes_W * point.roll.impulse;
      torque_a += twist;
      torque_b += twist;
    }
    Body& a = BodyAt(joint.a);
    Body& b = BodyAt(joint.b);
    a.gradient_v -= impulse;
    a.gradient_w -= torque_a;
    b.gradient_v += impulse;
    b.gradient_w += torque_b;
  }
  double most = 0;
  for (const Body& body : bodies_) {
    const double energy = body.gradient_v.squaredNorm() / body.mass_kg +
                          body.gradient_w.dot(body.inverse_I_W * body.gradient_w);
    most = std::max(most, energy / body.mass_kg);
  }
  return std::sqrt(most);
}

void PileSolver::FindStep() {
  matrix_.Clear();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Matrix6& block = matrix_.diagonal(static_cast<int>(i));
    block.topLeftCorner<3, 3>().diagonal().setConstant(bodies_[i].mass_kg);
    block.bottomRightCorner<3, 3>() = bodies_[i].I_W;
  }
  Matrix6 unused;
  for (const Joint& joint : joints_) {
    // Adds Jᵀ K J of each point, with J = (1, −[r]×) for A and its negative for B, and K the stiffness in W.
    const bool has_a = joint.a != kNone, has_b = joint.b != kNone, has_both = has_a && has_b;
    Matrix6& of_a = has_a ? matrix_.diagonal(joint.a) : unused;
    Matrix6& of_b = has_b ? matrix_.diagonal(joint.b) : unused;
    Matrix6& of_both = has_both ? matrix_.edge(joint.edge) : unused;
    const bool is_turned = has_both && matrix_.is_turned(joint.edge);
    // Where K is the same in all directions: sums of it, of it times r, and of −[r]× K [r]×.
    double k_sum = 0;
    Vector3 k_a = Vector3::Zero(), k_b = k_a;
    Matrix3 aa = Matrix3::Zero(), bb = aa, ab = aa;
    bool has_sums = false;
    for (const Point& point : PointsOf(joint)) {
      if (point.slide.state == ContactLaw::State::kOpen) continue;
      if (point.slide.state == ContactLaw::State::kSticks && point.is_round) {
        has_sums = true;
        const double k = point.slide.hardness;
        k_sum += k;
        k_a += k * point.r_a;
        k_b += k * point.r_b;
        if (has_a) AddArms(k, point.r_a, point.r_a, aa);
        if (has_b) AddArms(k, point.r_b, point.r_b, bb);
        if (has_both) AddArms(k, point.r_a, point.r_b, ab);
      } else {
        for (const auto& [axis, k] : point.slide.Springs()) {
          if (k == 0) continue;
          const Vector3 axis_W = point.axes_W * axis;
          Vector6 J_a, J_b;
          J_a << axis_W, point.r_a.cross(axis_W);
          J_b << axis_W, point.r_b.cross(axis_W);
          if (has_a) AddProduct(k * J_a, J_a, of_a);
          if (has_b) AddProduct(k * J_b, J_b, of_b);
          if (has_both) AddProduct(-k * (is_turned ? J_b : J_a), is_turned ? J_a : J_b, of_both);
        }
      }
      if (!point.rolls) continue;
      has_sums = true;
      const Vector3 stiffness = point.roll.Stiffness(is_careful_);
      const Matrix3 twist = point.axes_W * stiffness.asDiagonal() * point.axes_W.transpose();
      aa += twist;
      bb += twist;
      ab += twist;
    }
    if (!has_sums) continue;
    const auto add = [&](Matrix6& block, double sign, const Vector3& row, const Vector3& column,
                         const Matrix3& turns) {
      block.topLeftCorner<3, 3>().diagonal().array() += sign * k_sum;
      AddCross(-sign * column, block.topRightCorner<3, 3>());
      AddCross(sign * row, block.bottomLeftCorner<3, 3>());
      block.bottomRightCorner<3, 3>() += sign * turns;
    };
    if (has_a) add(of_a, 1, k_a, k_a, aa);
    if (has_b) add(of_b, 1, k_b, k_b, bb);
    if (!has_both) continue;
    // In the row of the body whose column comes later.
    if (is_turned) {
      add(of_both, -1, k_b, k_a, ab.transpose());
    } else {
      add(of_both, -1, k_a, k_b, ab);
    }
  }
  matrix_.Factor();
  solution_.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    solution_[i] << -bodies_[i].gradient_v, -bodies_[i].gradient_w;
  }
  matrix_.Solve(solution_);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].step_v = solution_[i].head<3>();
    bodies_[i].step_w = solution_[i].tail<3>();
  }
}

double PileSolver::TakeStep() {
  AtPoints([](const Body& body) -> const Vector3& { return body.step_v; },
           [](const Body& body) -> const Vector3& { return body.step_w; },
           [](ContactLaw& law, const Vector3& rates) { law.change = rates; });
  // Without the contacts, the slope at the share s of the step is free_slope + s bend.
  double begin_slope = 0, free_slope = 0, bend = 0;
  for (const Body& body : bodies_) {
    const Vector3 momentum = body.mass_kg * body.step_v, spin = body.I_W * body.step_w;
    begin_slope += body.gradient_v.dot(body.step_v) + body.gradient_w.dot(body.step_w);
    free_slope += momentum.dot(body.v - body.free_v) + spin.dot(body.w - body.free_w);
    bend += momentum.dot(body.step_v) + spin.dot(body.step_w);
  }
  laws_.clear();
  for (const Point& point : points_) {
    laws_.emplace_back(point.slide);
    if (point.rolls) laws_.emplace_back(point.roll);
  }
  const auto slope_at = [&](double share) {
    StepSlope slope{free_slope + share * bend, bend};
    for (const LawAlongStep& law : laws_) law.AddTo(slope, share);
    return slope;
  };
  // The slope increases with the share: Newton's method, kept between bounds.
  constexpr double kFlat = 0.01;
  constexpr int kMostTrials = 20;
  const double flat = kFlat * std::abs(begin_slope);
  double share = 1, low = 0, high = 1;
  StepSlope slope = slope_at(share);
  if (!std::isfinite(begin_slope) || !std::isfinite(slope.value)) return kInfinity;  // no usable step
  for (int i = 0; i < kMostTrials && (slope.value > flat || (i > 0 && slope.value < -flat)); ++i) {
    (slope.value > 0 ? high : low) = share;
    share -= slope.value / slope.rise;
    if (!(share > low && share < high)) share = (low + high) / 2;
    slope = slope_at(share);
  }
  for (Point& point : points_) {
    point.slide.rate += share * point.slide.change;
    point.slide.Push();
    if (!point.rolls) continue;
    point.roll.rate += share * point.roll.change;
    point.roll.Push();
  }
  double most = 0;
  for (Body& body : bodies_) {
    body.v += share * body.step_v;
    body.w += share * body.step_w;
    most = std::max(most, body.step_v.squaredNorm());
  }
  return std::sqrt(most);
}

bool PileSolver::Solve(double dt_s) {
  for (Body& body : bodies_) {
    body.v = body.state.v_WB;
    body.w = body.state.w_WB;
  }
  // Tolerance of velocities: a thousandth of their change by gravity; in large piles, at least a thousandth
  // of the largest speed. Where things roll, of the mean speed: one that rolls on would loosen the others.
  constexpr double kExact = 1e-3;
  constexpr std::size_t kFew = 8;
  double enough_m_s = 1e-7 + kExact * settings_.g_W.norm() * dt_s;
  if (bodies_.size() > kFew) {
    double sum_m2_s2 = 0, most_m2_s2 = 0;
    for (const Body& body : bodies_) {
      sum_m2_s2 += body.v.squaredNorm();
      most_m2_s2 = std::max(most_m2_s2, body.v.squaredNorm());
    }
    const bool rolls = std::ranges::any_of(points_, &Point::rolls);
    const double mean_m2_s2 = sum_m2_s2 / static_cast<double>(bodies_.size());
    enough_m_s = std::max(enough_m_s, kExact * std::sqrt(rolls ? mean_m2_s2 : most_m2_s2));
  }
  AtPoints([](const Body& body) -> const Vector3& { return body.v; },
           [](const Body& body) -> const Vector3& { return body.w; },
           [](ContactLaw& law, const Vector3& rates) { law.rate = rates; });
  for (Point& point : points_) {
    point.slide.slip = 0;
    point.slide.Push();
  }
  // The first iterations update slips and loads. Afterwards they are fixed, so that the problem is convex.
  const int most_iterations = is_careful_ ? 60 : 30, with_loads = is_careful_ ? 30 : 6;
  std::vector<ContactLaw::State> assumed(points_.size());
  double step_m_s = 0;
  for (int i = 0; i < most_iterations; ++i) {
    const bool rolls = i > 0 || !is_careful_;  // without rolling friction it is no solution yet
    const double change_m_s = i < with_loads ? UpdateLoads(rolls) : 0;
    if (FindGradient() < enough_m_s && rolls) {
      step_m_s = 0;
      break;
    }
    if (i == 0) matrix_.Plan(static_cast<int>(bodies_.size()), edges_);
    FindStep();
    for (std::size_t k = 0; k < points_.size(); ++k) assumed[k] = points_[k].slide.state;
    step_m_s = TakeStep();
    if (step_m_s == kInfinity) break;
    // A step that assumed that things stick is tiny, but not the last if they begin to slide.
    const auto is_assumed = [](const Point& point, ContactLaw::State state) {
      return point.slide.state == state;
    };
    if (rolls && std::max(step_m_s, change_m_s) < enough_m_s &&
        (bodies_.size() > kFew || std::ranges::equal(points_, assumed, is_assumed)))
      break;
  }
  constexpr double kNear_m_s = 0.01;
  return step_m_s < kNear_m_s;
}

bool PileSolver::Step(double dt_s) {
  edges_.clear();
  for (Joint& joint : joints_) {
    if (joint.a == kNone || joint.b == kNone) continue;
    joint.edge = edges_.size();
    edges_.emplace_back(joint.a, joint.b);
  }
  is_careful_ = std::ranges::any_of(points_, &Point::rolls);
  bool is_solved = Solve(dt_s);
  if (!is_solved) {
    is_careful_ = !is_careful_;
    is_solved = Solve(dt_s);
  }
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    const Point& point = points_[measured_points_[i]];
    measured_[i].force_W = point.axes_W * point.slide.impulse / dt_s;
  }
  Move(dt_s);
  return is_solved;
}

void PileSolver::Move(double dt_s) {
  for (Body& body : bodies_) {
    BodyState& state = body.state;
    state.v_WB = body.v;
    state.w_WB = body.w;
    state.p_WB += dt_s * state.v_WB;
    const double rate = state.w_WB.norm();
    if (rate > 0) {
      const Quaternion q(state.q_WB[0], state.q_WB[1], state.q_WB[2], state.q_WB[3]);
      Orient(state, (portable::AngleAxis(dt_s * rate, state.w_WB / rate) * q).normalized());
    }
    state.sleep_counter = 0;
  }
}

}  // namespace coopdyn
