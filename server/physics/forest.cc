// SPDX-License-Identifier: MIT
#include "server/physics/forest.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "server/base/portable_math.h"

namespace coopdyn {

namespace {

using Kind = JointModel::Kind;

Spatial Join(const Vector3& angular, const Vector3& linear) {
  Spatial joined;
  joined << angular, linear;
  return joined;
}

/// Change of a motion that moves with `v`.
Spatial CrossMotion(const Spatial& v, const Spatial& motion) {
  const Vector3 w = v.head<3>(), m = motion.head<3>();
  return Join(w.cross(m), v.tail<3>().cross(m) + w.cross(motion.tail<3>()));
}

/// Change of a force, or a momentum, that moves with `v`.
Spatial CrossForce(const Spatial& v, const Spatial& force) {
  const Vector3 w = v.head<3>(), f = force.tail<3>();
  return Join(w.cross(force.head<3>()) + v.tail<3>().cross(f), w.cross(f));
}

/// The rotation of `dt_s` at `w`.
Quaternion Turn(const Vector3& w, double dt_s) {
  const double rate = w.norm();
  if (rate == 0) return Quaternion::Identity();
  return portable::AngleAxis(rate * dt_s, w / rate);
}

/// The first axis, on the side of the root, and the second.
struct TwoAxes {
  Vector3 first, second;
};
TwoAxes AxesOf(const JointModel& joint, int sign) {
  return sign > 0 ? TwoAxes{joint.axis_R, joint.axis2_R} : TwoAxes{joint.axis2_R, joint.axis_R};
}

/// A point of the model as a body carries it.
Vector3 Carried(const BodyState& body, const Quaternion& R_WR, const RigidBody& rigid, const Vector3& p_R) {
  return body.p_WB + R_WR * (p_R - rigid.X_RB.p);
}

void Orient(BodyState& body, const Quaternion& q) {
  body.q_WB = {q.w(), q.x(), q.y(), q.z()};
  const Matrix3 R = q.toRotationMatrix();
  for (int i = 0; i < 9; ++i) body.R_WB[static_cast<std::size_t>(i)] = R(i / 3, i % 3);
}

}  // namespace

double AngleAbout(const Quaternion& q, const Vector3& axis) {
  return std::remainder(2 * portable::Atan2(q.vec().dot(axis), q.w()), 2 * std::numbers::pi);
}

void Forest::Inertia::operator+=(const Inertia& other) {
  mass += other.mass;
  moment += other.moment;
  I += other.I;
}

Spatial Forest::Inertia::operator*(const Spatial& v) const {
  const Vector3 w = v.head<3>(), u = v.tail<3>();
  return Join(I * w + moment.cross(u), mass * u - moment.cross(w));
}

void Forest::Clear() {
  nodes_.clear();
  parents_.clear();
  depths_.clear();
  offsets_.clear();
  axes_.clear();
  rates_.clear();
  paths_.clear();
}

void Forest::AddDofs(Node& node, int index) {
  const int above = node.parent == kNone ? kNone : at(nodes_, node.parent).end;
  node.first_dof = dof_count();
  node.end = above;
  for (int k = 0; k < at(nodes_, index).dofs; ++k) {
    const int dof = dof_count();
    const std::size_t offset = paths_.size();
    const int depth = node.end == kNone ? 0 : at(depths_, node.end) + 1;
    if (node.end != kNone) {
      const std::size_t from = at(offsets_, node.end);
      for (int d = 0; d < depth; ++d) paths_.push_back(paths_[from + static_cast<std::size_t>(d)]);
    }
    paths_.push_back(dof);
    parents_.push_back(node.end);
    depths_.push_back(depth);
    offsets_.push_back(offset);
    axes_.emplace_back();
    rates_.push_back(0);
    node.end = dof;
  }
}

int Forest::Add(const Mechanism& mechanism, std::span<const BodyState> bodies) {
  const int first = node_count();
  for (const LimbNode& limb : mechanism.tree.nodes) {
    const int index = node_count();
    Node& node = nodes_.emplace_back();
    node.rigid = &mechanism.bodies[static_cast<std::size_t>(limb.body)];
    node.state = bodies[static_cast<std::size_t>(limb.body)];
    node.state.sleep_counter = 0;
    node.sign = limb.sign;
    node.dofs = limb.dofs;
    node.R_WR = node.state.orientation() * node.rigid->X_RB.q.conjugate();
    if (limb.joint >= 0) {
      node.model = mechanism.joints[static_cast<std::size_t>(limb.joint)].model;
      node.parent = first + limb.parent;
    }
    node.origin = limb.parent < 0 ? node.state.p_WB : at(nodes_, node.parent).origin;
    AddDofs(node, index);
    if (node.model != nullptr) Measure(node);
    AddAxes(node);
  }
  return first;
}

void Forest::Measure(Node& node) {
  const Node& parent = at(nodes_, node.parent);
  const JointModel& joint = *node.model;
  const Quaternion q = parent.R_WR.conjugate() * node.R_WR;
  const Vector3 w = node.state.w_WB - parent.state.w_WB, axis_W = node.R_WR * joint.axis_R;
  double* const rates = &at(rates_, node.first_dof);
  const auto slide = [&] {
    const Vector3 here = Carried(node.state, node.R_WR, *node.rigid, joint.p_RJ);
    return node.sign * axis_W.dot(here - Carried(parent.state, parent.R_WR, *parent.rigid, joint.p_RJ));
  };
  switch (joint.kind) {
    case Kind::kHinge:
      node.position = node.sign * AngleAbout(q, joint.axis_R);
      rates[0] = node.sign * axis_W.dot(w);
      break;
    case Kind::kScrew:
      node.position = slide() / joint.pitch_m_rad;
      rates[0] = node.sign * axis_W.dot(w);
      break;
    case Kind::kSlider: {
      const Vector3 here = Carried(node.state, node.R_WR, *node.rigid, joint.p_RJ);
      const Vector3 v = node.state.v_WB + node.state.w_WB.cross(here - node.state.p_WB) - parent.state.v_WB -
                        parent.state.w_WB.cross(here - parent.state.p_WB);
      node.position = slide();
      rates[0] = node.sign * axis_W.dot(v);
      break;
    }
    case Kind::kUniversal: {
      const auto [a, b] = AxesOf(joint, node.sign);
      const Vector3 from = b - b.dot(a) * a, to = q * b;
      node.position = portable::Atan2(a.dot(from.cross(to)), from.dot(to));
      node.position2 = AngleAbout(portable::AngleAxis(-node.position, a) * q, b);
      const Vector3 a_W = parent.R_WR * a, b_W = node.R_WR * b;
      const double c = a_W.dot(b_W), x = a_W.dot(w), y = b_W.dot(w);
      rates[0] = (x - c * y) / (1 - c * c);
      rates[1] = (y - c * x) / (1 - c * c);
      break;
    }
    case Kind::kBall:
      node.q_rel = q;
      for (int i = 0; i < 3; ++i) rates[i] = w[i];
      break;
    case Kind::kMuscle:  // in no tree
    case Kind::kForce:
    case Kind::kTorque:
    case Kind::kLimiter:
      break;
  }
}

void Forest::AddAxes(const Node& node) {
  if (node.dofs == 0) return;
  Spatial* const axes = &at(axes_, node.first_dof);
  if (node.model == nullptr) {
    // About the tree's point, which is a root's centre of mass.
    for (int i = 0; i < 6; ++i) {
      axes[i] = Spatial::Unit(i);
      at(rates_, node.first_dof + i) = i < 3 ? node.state.w_WB[i] : node.state.v_WB[i - 3];
    }
    return;
  }
  const JointModel& joint = *node.model;
  const Node& parent = at(nodes_, node.parent);
  const Vector3 lever = node.origin - Carried(node.state, node.R_WR, *node.rigid, joint.p_RJ);
  const auto turning = [&](const Vector3& axis_W) { return Join(axis_W, axis_W.cross(lever)); };
  const Vector3 axis_W = node.sign * (node.R_WR * joint.axis_R);
  switch (joint.kind) {
    case Kind::kHinge:
      axes[0] = turning(axis_W);
      break;
    case Kind::kScrew:
      axes[0] = turning(axis_W) + Join(Vector3::Zero(), joint.pitch_m_rad * axis_W);
      break;
    case Kind::kSlider:
      axes[0] = Join(Vector3::Zero(), axis_W);
      break;
    case Kind::kUniversal: {
      const auto [a, b] = AxesOf(joint, node.sign);
      axes[0] = turning(parent.R_WR * a);
      axes[1] = turning(node.R_WR * b);
      break;
    }
    case Kind::kBall:
      for (int i = 0; i < 3; ++i) axes[i] = turning(Vector3::Unit(i));
      break;
    case Kind::kMuscle:
    case Kind::kForce:
    case Kind::kTorque:
    case Kind::kLimiter:
      break;
  }
}

Vector3 Forest::Point(int node, const Vector3& p_R) const {
  const Node& of = at(nodes_, node);
  return Carried(of.state, of.R_WR, *of.rigid, p_R);
}

void Forest::Begin(double gravity_m_s2, double dt_s) {
  gravity_m_s2_ = gravity_m_s2;
  dt_s_ = dt_s;
  for (Node& node : nodes_) {
    // Its inertia about the tree's point.
    const Vector3 c = node.state.p_WB - node.origin;
    const Matrix3 R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(node.state.R_WB.data());
    const double mass = node.rigid->mass_kg;
    node.inertia = {mass, mass * c,
                    R * node.rigid->inertia_kg_m2 * R.transpose() +
                        mass * (c.squaredNorm() * Matrix3::Identity() - c * c.transpose())};
    node.subtree = node.inertia;
  }
  mass_.resize(paths_.size());
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    const Node& node = nodes_[n];
    for (int dof = node.first_dof; dof < node.first_dof + node.dofs; ++dof) {
      const Spatial force = node.subtree * at(axes_, dof);
      double* const row = mass_.data() + at(offsets_, dof);
      const std::span<const int> chain = Chain(dof);
      for (std::size_t d = 0; d < chain.size(); ++d) row[d] = at(axes_, chain[d]).dot(force);
    }
    if (node.parent != kNone) at(nodes_, node.parent).subtree += node.subtree;
  }
  momentum_.resize(rates_.size());
  AddUp(rates_, true);
}

void Forest::TakeForcesAt(std::span<const double> rates) {
  AddUp(rates, false);
}

void Forest::AddUp(std::span<const double> rates, bool at_start) {
  const Spatial up = Join(Vector3::Zero(), gravity_m_s2_ * Vector3::UnitZ());
  for (Node& node : nodes_) {
    const double* const own = rates.data() + node.first_dof;
    if (node.model == nullptr) {
      node.velocity.setZero();
      node.bias = up;
      if (node.dofs > 0) {
        const Vector3 w(own), v(own + 3);
        node.velocity = Join(w, v);
        node.bias.tail<3>() -= w.cross(v);
      }
    } else {
      const Node& parent = at(nodes_, node.parent);
      node.velocity = parent.velocity;
      node.bias = parent.bias;
      if (node.model->kind == Kind::kBall) {
        const Vector3 p = Carried(node.state, node.R_WR, *node.rigid, node.model->p_RJ) - node.origin;
        const Vector3 v = parent.velocity.tail<3>() + parent.velocity.head<3>().cross(p);
        const Vector3 w(own);
        node.bias.tail<3>() -= w.cross(v);
        for (int k = 0; k < 3; ++k) node.velocity += w[k] * at(axes_, node.first_dof + k);
      } else {
        for (int k = 0; k < node.dofs; ++k) {
          const Spatial moves = own[k] * at(axes_, node.first_dof + k);
          node.bias += CrossMotion(node.velocity, moves);
          node.velocity += moves;
        }
      }
    }
    const Spatial momentum = node.inertia * node.velocity;
    if (at_start) node.momentum = momentum;
    node.force = node.momentum - dt_s_ * (node.inertia * node.bias + CrossForce(node.velocity, momentum));
  }
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    const Node& node = nodes_[n];
    for (int dof = node.first_dof; dof < node.first_dof + node.dofs; ++dof)
      at(momentum_, dof) = at(axes_, dof).dot(node.force);
    if (node.parent != kNone) at(nodes_, node.parent).force += node.force;
  }
}

void Forest::Factor(std::span<const double> added) {
  matrix_ = mass_;
  pivots_.resize(rates_.size());
  for (int k = 0; k < dof_count(); ++k) RowOf(k)[at(depths_, k)] += at(added, k);
  for (int k = dof_count() - 1; k >= 0; --k) {
    double* const row = RowOf(k);
    const int depth = at(depths_, k);
    const double pivot = row[depth];
    at(pivots_, k) = pivot;
    const std::span<const int> chain = Chain(k);
    for (int d = depth - 1; d >= 0; --d) {
      const double share = row[d] / pivot;
      double* const above = RowOf(chain[static_cast<std::size_t>(d)]);
      for (int e = 0; e <= d; ++e) above[e] -= share * row[e];
      row[d] = share;
    }
  }
}

void Forest::AddWrench(int node, const Vector3& p_W, const Vector3& torque, const Vector3& force,
                       std::span<double> row) const {
  const Node& of = at(nodes_, node);
  if (of.end == kNone) return;
  const Spatial wrench = Join(torque + (p_W - of.origin).cross(force), force);
  const std::span<const int> chain = Chain(of.end);
  for (std::size_t d = 0; d < chain.size(); ++d) row[d] += at(axes_, chain[d]).dot(wrench);
}

void Forest::Transform(int end, std::span<double> row) const {
  const std::span<const int> chain = Chain(end);
  for (std::size_t d = chain.size(); d-- > 1;) {
    const double* const of = RowOf(chain[d]);
    const double value = row[d];
    for (std::size_t e = 0; e < d; ++e) row[e] -= value * of[e];
  }
}

void Forest::Transform(std::span<double> momentum) const {
  for (int k = dof_count() - 1; k >= 0; --k) {
    const std::span<const int> chain = Chain(k);
    const double* const of = RowOf(k);
    const double value = at(momentum, k);
    for (std::size_t e = 0; e + 1 < chain.size(); ++e) at(momentum, chain[e]) -= value * of[e];
    at(momentum, k) = value / at(pivots_, k);
  }
}

void Forest::Finish(std::span<double> transformed) const {
  for (int k = 0; k < dof_count(); ++k) {
    const std::span<const int> chain = Chain(k);
    const double* const of = RowOf(k);
    double value = at(transformed, k);
    for (std::size_t e = 0; e + 1 < chain.size(); ++e) value -= of[e] * at(transformed, chain[e]);
    at(transformed, k) = value;
  }
}

void Forest::Move(std::span<const double> rates, double dt_s) {
  for (Node& node : nodes_) {
    if (node.model == nullptr) {
      if (node.dofs == 0) continue;
      const double* const now = rates.data() + node.first_dof;
      BodyState& body = node.state;
      body.w_WB = Vector3(now);
      body.v_WB = Vector3(now + 3);
      const Quaternion q = (Turn(body.w_WB, dt_s) * body.orientation()).normalized();
      Orient(body, q);
      body.p_WB += dt_s * body.v_WB;
      node.R_WR = q * node.rigid->X_RB.q.conjugate();
    } else {
      Place(node, rates, dt_s);
    }
  }
}

void Forest::Place(Node& node, std::span<const double> rates, double dt_s) {
  const Node& parent = at(nodes_, node.parent);
  const JointModel& joint = *node.model;
  const double* const now = rates.data() + node.first_dof;
  Quaternion q = Quaternion::Identity();  // in the parent
  Vector3 w_W = Vector3::Zero();          // against it
  double slide_m = 0, slide_m_s = 0;
  if (joint.kind == Kind::kBall) {
    const Quaternion R_WP = node.R_WR * node.q_rel.conjugate();  // the parent's before
    w_W = Vector3(now);
    q = Turn(R_WP.conjugate() * w_W, dt_s) * node.q_rel;
  } else {
    node.position += dt_s * now[0];
    if (joint.kind == Kind::kUniversal) {
      node.position2 += dt_s * now[1];
      const auto [a, b] = AxesOf(joint, node.sign);
      q = portable::AngleAxis(node.position, a) * portable::AngleAxis(node.position2, b);
      w_W = parent.R_WR * (now[0] * a + now[1] * (q * b));
    } else {
      const bool slides = joint.kind == Kind::kSlider;
      const double way_m = slides ? 1 : joint.kind == Kind::kScrew ? joint.pitch_m_rad : 0;
      slide_m = node.sign * way_m * node.position;
      slide_m_s = node.sign * way_m * now[0];
      if (!slides) {
        q = portable::AngleAxis(node.sign * node.position, joint.axis_R);
        w_W = parent.R_WR * (node.sign * now[0] * joint.axis_R);
      }
    }
  }
  BodyState& body = node.state;
  node.R_WR = (parent.R_WR * q).normalized();
  const Vector3 axis_W = parent.R_WR * joint.axis_R;
  const Vector3 anchor = Carried(parent.state, parent.R_WR, *parent.rigid, joint.p_RJ) + slide_m * axis_W;
  body.p_WB = anchor + node.R_WR * (node.rigid->X_RB.p - joint.p_RJ);
  body.w_WB = parent.state.w_WB + w_W;
  body.v_WB = parent.state.v_WB + parent.state.w_WB.cross(anchor - parent.state.p_WB) + slide_m_s * axis_W +
              body.w_WB.cross(body.p_WB - anchor);
  Orient(body, (node.R_WR * node.rigid->X_RB.q).normalized());
}

}  // namespace coopdyn
