// SPDX-License-Identifier: MIT
// Kinematics and energy of a forest's bodies.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/base/portable_math.h"
#include "server/physics/forest.h"
#include "server/physics/rest.h"

namespace coopdyn {

namespace {

using Kind = JointModel::Kind;

/// The rotation by turning at `w` for `dt_s`.
Quaternion Turn(const Vector3& w, double dt_s) {
  const double rate = w.norm();
  if (rate == 0) return Quaternion::Identity();
  return portable::AngleAxis(rate * dt_s, w / rate);
}

/// A universal joint's axes; the first is on the root's side.
struct TwoAxes {
  Vector3 first, second;
};
TwoAxes AxesOf(const JointModel& joint, int sign) {
  return sign > 0 ? TwoAxes{joint.axis_R, joint.axis2_R} : TwoAxes{joint.axis2_R, joint.axis_R};
}

}  // namespace

double AngleAbout(const Quaternion& q, const Vector3& axis) {
  return std::remainder(2 * portable::Atan2(q.vec().dot(axis), q.w()), 2 * std::numbers::pi);
}

void Forest::Measure(Node& node) {
  const Node& parent = at(nodes_, node.parent);
  const JointModel& joint = *node.model;
  const Quaternion q = parent.R_WR.conjugate() * node.R_WR;
  const Vector3 w = node.state.w_WB - parent.state.w_WB;
  double* const rates = &at(rates_, node.first_dof);
  const auto slide = [&] {
    const Vector3 here = Carried(node, joint.p_RJ);
    return node.axis_W.dot(here - Carried(parent, joint.p_RJ));
  };
  switch (joint.kind) {
    case Kind::kHinge:
      node.position = node.sign * AngleAbout(q, joint.axis_R);
      rates[0] = node.axis_W.dot(w);
      break;
    case Kind::kScrew:
      node.position = slide() / joint.pitch_m_rad;
      rates[0] = node.axis_W.dot(w);
      break;
    case Kind::kSlider: {
      const Vector3 here = Carried(node, joint.p_RJ);
      const Vector3 v = node.state.v_WB + node.state.w_WB.cross(here - node.state.p_WB) - parent.state.v_WB -
                        parent.state.w_WB.cross(here - parent.state.p_WB);
      node.position = slide();
      rates[0] = node.axis_W.dot(v);
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
    // About the tree's reference point, the root's centre of mass.
    for (int i = 0; i < 6; ++i) axes[i] = Spatial::Unit(i);
    return;
  }
  const JointModel& joint = *node.model;
  const Node& parent = at(nodes_, node.parent);
  const Vector3 lever = node.origin - (node.state.p_WB - node.arm_W);
  const auto turning = [&](const Vector3& axis_W) { return Join(axis_W, axis_W.cross(lever)); };
  switch (joint.kind) {
    case Kind::kHinge:
      axes[0] = turning(node.axis_W);
      break;
    case Kind::kScrew:
      axes[0] = turning(node.axis_W) + Join(Vector3::Zero(), joint.pitch_m_rad * node.axis_W);
      break;
    case Kind::kSlider:
      axes[0] = Join(Vector3::Zero(), node.axis_W);
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
  return Carried(of, p_R);
}

void Forest::Move(std::span<const double> rates, double dt_s) {
  for (Node& node : nodes_) {
    const double* const own = rates.data() + node.first_dof;
    if (node.model != nullptr) {
      Place(node, own, dt_s);
    } else if (node.dofs > 0) {
      const Quaternion q = (Turn(Vector3(own), dt_s) * node.state.orientation()).normalized();
      Orient(node.state, q);
      node.state.p_WB += dt_s * Vector3(own + 3);
      node.R_WR = q * node.rigid->X_RB.q.conjugate();
    }
  }
}

void Forest::SetRates(std::span<const double> rates) {
  for (Node& node : nodes_) {
    const double* const own = rates.data() + node.first_dof;
    BodyState& body = node.state;
    if (node.model == nullptr) {
      if (node.dofs == 0) continue;
      body.w_WB = Vector3(own);
      body.v_WB = Vector3(own + 3);
      continue;
    }
    const JointModel& joint = *node.model;
    node.rate = own[0];
    const BodyState& parent = at(nodes_, node.parent).state;
    const Vector3 to_joint = body.p_WB - node.arm_W - parent.p_WB;
    body.w_WB = parent.w_WB;
    body.v_WB = parent.v_WB + parent.w_WB.cross(to_joint);
    if (joint.kind == Kind::kBall) {
      body.w_WB += Vector3(own);
    } else if (joint.kind == Kind::kUniversal) {
      const auto [a, b] = AxesOf(joint, node.sign);
      body.w_WB += own[0] * (at(nodes_, node.parent).R_WR * a) + own[1] * (node.R_WR * b);
    } else {
      const Vector3 moves = own[0] * node.axis_W;
      if (joint.kind != Kind::kSlider) body.w_WB += moves;
      if (joint.kind == Kind::kSlider) body.v_WB += moves;
      if (joint.kind == Kind::kScrew) body.v_WB += joint.pitch_m_rad * moves;
    }
    body.v_WB += body.w_WB.cross(node.arm_W);
  }
}

void Forest::Save() {
  saved_postures_.assign(nodes_.begin(), nodes_.end());
  saved_rates_ = rates_;
}

void Forest::Return() {
  for (std::size_t i = 0; i < nodes_.size(); ++i) static_cast<Posture&>(nodes_[i]) = saved_postures_[i];
  rates_ = saved_rates_;
}

void Forest::Continue(std::span<const double> rates) {
  rates_.assign(rates.begin(), rates.end());
  for (Node& node : nodes_) {
    node.origin = node.model == nullptr ? node.state.p_WB : at(nodes_, node.parent).origin;
    AddAxes(node);
  }
}

bool Forest::IsViolent() const {
  constexpr double kViolent_rad_s = 1000;
  return std::ranges::any_of(nodes_, [](const Node& node) {
    return LimitRatio(node.state) > 1 || node.state.w_WB.norm() > kViolent_rad_s;
  });
}

Forest::Energy Forest::EnergyAt(const Vector3& g_W) const {
  Energy energy;
  for (const Node& node : nodes_) {
    const BodyState& body = node.state;
    const Vector3 w_B = RotationOf(body).transpose() * body.w_WB;
    energy.kinetic_j +=
        (node.rigid->mass_kg * body.v_WB.squaredNorm() + w_B.dot(node.rigid->inertia_kg_m2 * w_B) +
         ArmatureOf(node) * node.rate * node.rate) /
        2;
    energy.potential_j -= (node.rigid->mass_kg * g_W).dot(body.p_WB);
  }
  return energy;
}

void Forest::Slow(double energy_j, double kinetic_j, std::span<double> rates) {
  struct Floating {
    int root = 0;
    Vector3 w_W, v_W;  // twist of the root's body if the tree were rigid
  };
  std::vector<Floating> floating;
  double inner_j = kinetic_j;
  for (int first = 0; first < node_count();) {
    int end = first + 1;
    while (end < node_count() && at(nodes_, end).model != nullptr) ++end;
    const std::span<const Node> tree =
        std::span(nodes_).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(end - first));
    first = end;
    if (tree.front().dofs == 0) continue;
    Inertia whole;
    Spatial momentum = Spatial::Zero();
    for (const Node& node : tree) {
      const Inertia inertia = InertiaOf(node, tree.front().state.p_WB);
      whole += inertia;
      const Vector3& w = node.state.w_WB;
      const Vector3 v = node.state.v_WB + w.cross(tree.front().state.p_WB - node.state.p_WB);
      momentum += Join(inertia.Angular(w, v), inertia.Linear(w, v));
    }
    const Spatial rigid = whole.matrix().ldlt().solve(momentum);
    inner_j -= rigid.dot(momentum) / 2;
    floating.push_back({end - static_cast<int>(tree.size()), rigid.head<3>(), rigid.tail<3>()});
  }
  if (!(inner_j > 0)) return;
  const double scale = std::sqrt(std::clamp(1 - energy_j / inner_j, 0.0, 4.0));
  for (double& rate : rates) rate *= scale;
  for (const Floating& tree : floating) {
    for (int i = 0; i < 3; ++i) {
      double* const own = &rates[static_cast<std::size_t>(at(nodes_, tree.root).first_dof)];
      own[i] += (1 - scale) * tree.w_W[i];
      own[i + 3] += (1 - scale) * tree.v_W[i];
    }
  }
  SetRates(rates);
}

void Forest::Carry(Node& node) {
  node.arm_W = node.R_WR * node.arm_R;
  if (node.model->has_axis()) node.axis_W = node.sign * (node.R_WR * node.model->axis_R);
}

void Forest::Place(Node& node, const double* rates, double dt_s) {
  const Node& parent = at(nodes_, node.parent);
  const JointModel& joint = *node.model;
  BodyState& body = node.state;
  body.p_WB = Carried(parent, joint.p_RJ);
  if (joint.kind == Kind::kBall) {
    const Quaternion R_WP = node.R_WR * node.q_rel.conjugate();  // the parent's before the move
    node.q_rel = (Turn(R_WP.conjugate() * Vector3(rates), dt_s) * node.q_rel).normalized();
    node.R_WR = parent.R_WR * node.q_rel;
  } else {
    node.position += dt_s * rates[0];
    if (joint.kind == Kind::kUniversal) {
      node.position2 += dt_s * rates[1];
      const auto [a, b] = AxesOf(joint, node.sign);
      node.R_WR =
          parent.R_WR * portable::AngleAxis(node.position, a) * portable::AngleAxis(node.position2, b);
    } else if (joint.kind == Kind::kSlider) {
      node.R_WR = parent.R_WR;
      body.p_WB += node.sign * node.position * (node.R_WR * joint.axis_R);
    } else {
      node.R_WR = parent.R_WR * portable::AngleAxis(node.sign * node.position, joint.axis_R);
      if (joint.kind == Kind::kScrew)
        body.p_WB += node.sign * joint.pitch_m_rad * node.position * (node.R_WR * joint.axis_R);
    }
  }
  node.R_WR.normalize();
  Carry(node);
  body.p_WB += node.arm_W;
  Orient(body, node.R_WR * node.rigid->X_RB.q);
}

void Forest::SlowJoints(double share, std::span<double> rates) {
  for (const Node& node : nodes_) {
    if (node.model == nullptr) continue;
    for (int dof = node.first_dof; dof < node.first_dof + node.dofs; ++dof) at(rates, dof) *= share;
  }
  SetRates(rates);
}

double Forest::TurnRate_rad_s() const {
  double most = 0;
  for (const Node& node : nodes_) most = std::max(most, node.state.w_WB.squaredNorm());
  return std::sqrt(most);
}

double Forest::FreeTurnRate_rad_s() const {
  double most = 0;
  for (const Node& node : nodes_) {
    if (node.dofs < 3) continue;
    most =
        std::max(most, Eigen::Map<const Vector3>(&rates_[static_cast<std::size_t>(node.first_dof)]).norm());
  }
  return most;
}

}  // namespace coopdyn
