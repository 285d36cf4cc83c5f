// SPDX-License-Identifier: MIT
#include "server/physics/forest.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/base/portable_math.h"
#include "server/physics/rest.h"

namespace coopdyn {

namespace {

using Kind = JointModel::Kind;

}  // namespace

void Forest::Inertia::operator+=(const Inertia& other) {
  mass += other.mass;
  moment += other.moment;
  I += other.I;
}

Forest::Matrix6 Forest::Inertia::matrix() const {
  const Vector3& h = moment;
  Matrix3 cross;
  cross << 0, -h.z(), h.y(), h.z(), 0, -h.x(), -h.y(), h.x(), 0;
  Matrix6 full;
  full << I, cross, cross.transpose(), mass * Matrix3::Identity();
  return full;
}

void Forest::Clear() {
  nodes_.clear();
  depths_.clear();
  offsets_.clear();
  axes_.clear();
  rates_.clear();
  paths_.clear();
  rotors_.clear();
}

void Forest::AddDofs(Node& node, int index) {
  const int above = node.parent == kNone ? kNone : at(nodes_, node.parent).end;
  node.first_dof = dof_count();
  node.end = above;
  for (int k = 0; k < at(nodes_, index).dofs; ++k) {
    const int dof = dof_count();
    const std::size_t offset = paths_.size();
    const int depth = node.end == kNone ? 0 : at(depths_, node.end) + 1;
    paths_.resize(offset + static_cast<std::size_t>(depth) + 1);
    if (node.end != kNone)
      std::copy_n(&at(paths_, static_cast<int>(at(offsets_, node.end))), depth, &paths_[offset]);
    paths_.back() = dof;
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
    if (node.model != nullptr) {
      node.arm_R = node.rigid->X_RB.p - node.model->p_RJ;
      Carry(node);
    }
    node.origin = limb.parent < 0 ? node.state.p_WB : at(nodes_, node.parent).origin;
    AddDofs(node, index);
    if (node.model != nullptr) {
      Measure(node);
      if (node.dofs > 0) node.rate = at(rates_, node.first_dof);
    } else if (node.dofs > 0) {
      Eigen::Map<Spatial>(&at(rates_, node.first_dof)) = Join(node.state.w_WB, node.state.v_WB);
    }
    AddAxes(node);
    CountTurns(index);
  }
  return first;
}

void Forest::CountTurns(int index) {
  Node& node = at(nodes_, index);
  if (node.model == nullptr) {
    node.turns = node.dofs > 0 ? 2 : 0;
    return;
  }
  const Node& parent = at(nodes_, node.parent);
  const Kind kind = node.model->kind;
  node.turns = parent.turns;
  node.turn_W = parent.turn_W;
  if (kind == Kind::kBall || kind == Kind::kUniversal) node.turns = 2;
  if (kind != Kind::kHinge && kind != Kind::kScrew) return;
  constexpr double kParallel = 1e-9;  // sine squared
  if (parent.turns == 0) {
    node.turns = 1;
    node.turn_W = node.axis_W;
  } else if (parent.turns == 1 && parent.turn_W.cross(node.axis_W).squaredNorm() > kParallel) {
    node.turns = 2;
  }
  if (kind != Kind::kHinge || node.model->upper - node.model->lower <= 2 * std::numbers::pi) return;
  std::erase(rotors_, node.parent);
  if (parent.turns == 2) rotors_.push_back(index);
}

Forest::Inertia Forest::InertiaOf(const Node& node, const Vector3& p_W) {
  const Vector3 c = node.state.p_WB - p_W;
  const Matrix3 R = RotationOf(node.state);
  const double mass = node.rigid->mass_kg;
  const Vector3 moment = mass * c;
  Matrix3 I = R * node.rigid->inertia_kg_m2 * R.transpose();
  I.diagonal().array() += moment.dot(c);
  I -= moment * c.transpose();
  return {mass, moment, I};
}

void Forest::Begin(const Vector3& g_W, double dt_s) {
  g_W_ = g_W;
  dt_s_ = dt_s;
  for (Node& node : nodes_) node.inertia = InertiaOf(node, node.origin);
  momentum_.resize(rates_.size());
  AddUp(rates_, true);
}

void Forest::ComputeMasses() {
  masses_.resize(rates_.size());
  for (Node& node : nodes_) node.subtree = node.inertia;
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    const Node& node = nodes_[n];
    for (int dof = node.first_dof; dof < node.first_dof + node.dofs; ++dof) {
      const Vector3 w = at(axes_, dof).head<3>(), v = at(axes_, dof).tail<3>();
      at(masses_, dof) =
          w.dot(node.subtree.Angular(w, v)) + v.dot(node.subtree.Linear(w, v)) + ArmatureOf(node);
    }
    if (node.parent != kNone) at(nodes_, node.parent).subtree += node.subtree;
  }
}

void Forest::EvaluateForcesAt(std::span<const double> rates) {
  AddUp(rates, false);
}

void Forest::AddUp(std::span<const double> rates, bool at_start) {
  for (Node& node : nodes_) {
    const double* const own = rates.data() + node.first_dof;
    Vector3 w = Vector3::Zero(), v = w, dw = w, dv = w - g_W_;
    if (node.model == nullptr) {
      if (node.dofs > 0) {
        w = Vector3(own);
        v = Vector3(own + 3);
        dv -= w.cross(v);
      }
    } else {
      const Node& parent = at(nodes_, node.parent);
      w = parent.velocity.angular;
      v = parent.velocity.linear;
      dw = parent.bias.angular;
      dv = parent.bias.linear;
      if (node.model->kind == Kind::kBall) {
        const Vector3 turns(own);
        dv -= turns.cross(v + w.cross(node.state.p_WB - node.arm_W - node.origin));
        for (int k = 0; k < 3; ++k) v += own[k] * at(axes_, node.first_dof + k).tail<3>();
        w += turns;
      } else {
        for (int k = 0; k < node.dofs; ++k) {
          const Spatial& axis = at(axes_, node.first_dof + k);
          const Vector3 turns = own[k] * axis.head<3>(), slides = own[k] * axis.tail<3>();
          dw += w.cross(turns);
          dv += v.cross(turns) + w.cross(slides);
          w += turns;
          v += slides;
        }
      }
    }
    node.velocity = {w, v};
    node.bias = {dw, dv};
    const Inertia inertia = node.inertia;
    const Vector3 L = inertia.Angular(w, v), P = inertia.Linear(w, v);
    if (at_start) node.momentum = {L, P};
    const Vector3 torque = inertia.Angular(dw, dv) + w.cross(L) + v.cross(P);
    const Vector3 load = inertia.Linear(dw, dv) + w.cross(P);
    node.load = load;
    node.force.head<3>() = node.momentum.angular - dt_s_ * torque;
    node.force.tail<3>() = node.momentum.linear - dt_s_ * load;
  }
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    const Node& node = nodes_[n];
    for (int dof = node.first_dof; dof < node.first_dof + node.dofs; ++dof)
      at(momentum_, dof) = at(axes_, dof).dot(node.force) + ArmatureOf(node) * at(rates_, dof);
    if (node.parent != kNone) at(nodes_, node.parent).force += node.force;
  }
}

void Forest::Factor(std::span<const double> added) {
  gains_.resize(rates_.size());
  pivots_.resize(rates_.size());
  for (Node& node : nodes_) node.articulated = node.inertia.matrix();
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    for (int dof = node.first_dof + node.dofs; dof-- > node.first_dof;) {
      const Spatial& axis = at(axes_, dof);
      const Spatial moved = node.articulated * axis;
      const double pivot = axis.dot(moved) + at(added, dof) + ArmatureOf(node);
      const Spatial gain = moved / pivot;
      node.articulated -= gain * moved.transpose();
      at(pivots_, dof) = pivot;
      at(gains_, dof) = gain;
    }
    if (node.parent != kNone) at(nodes_, node.parent).articulated += node.articulated;
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
  Spatial passed = Spatial::Zero();
  for (std::size_t d = chain.size(); d-- > 0;) {
    row[d] -= at(axes_, chain[d]).dot(passed);
    passed += row[d] * at(gains_, chain[d]);
  }
}

void Forest::Transform(std::span<double> momentum) {
  for (Node& node : nodes_) node.passed.setZero();
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    for (int dof = node.first_dof + node.dofs; dof-- > node.first_dof;) {
      const double own = at(momentum, dof) - at(axes_, dof).dot(node.passed);
      node.passed += own * at(gains_, dof);
      at(momentum, dof) = own / at(pivots_, dof);
    }
    if (node.parent != kNone) at(nodes_, node.parent).passed += node.passed;
  }
}

void Forest::Finish(std::span<double> transformed) {
  for (Node& node : nodes_) {
    if (node.parent == kNone) {
      node.passed.setZero();
    } else {
      node.passed = at(nodes_, node.parent).passed;
    }
    for (int dof = node.first_dof; dof < node.first_dof + node.dofs; ++dof) {
      at(transformed, dof) -= at(gains_, dof).dot(node.passed);
      node.passed += at(transformed, dof) * at(axes_, dof);
    }
  }
}

double Forest::NutationRate_rad_s(double least_spin_rad_s) {
  const auto spins = [&](int rotor) {
    return std::abs(at(rates_, at(nodes_, rotor).first_dof)) > least_spin_rad_s;
  };
  if (std::ranges::none_of(rotors_, spins)) return 0;
  ComputeMasses();
  const auto carrier_of = [&](int rotor) -> Node& { return at(nodes_, at(nodes_, rotor).parent); };
  for (const int rotor : rotors_) carrier_of(rotor).spin_W.setZero();
  for (const int rotor : rotors_) {
    const Node& node = at(nodes_, rotor);
    const double inertia = MassOf(node.first_dof) - ArmatureOf(node);
    carrier_of(rotor).spin_W += inertia * at(rates_, node.first_dof) * node.axis_W;
  }
  double most = 0;
  for (const int rotor : rotors_) {
    Node& carrier = carrier_of(rotor);
    if (carrier.spin_W.isZero(0)) continue;
    most = std::max(most, NutationOf(carrier));
    carrier.spin_W.setZero();  // once for all of its rotors
  }
  return std::sqrt(most);
}

// A turn of the axle at w needs the torque w × spin, which turns the axle across: the product of the rates at
// which unit torques turn it in two directions is the nutation rate's square per spin momentum squared.
double Forest::NutationOf(const Node& carrier) {
  const Vector3 across_W = carrier.spin_W.unitOrthogonal();
  const Vector3 third_W = carrier.spin_W.normalized().cross(across_W);
  const std::span<const int> chain = Chain(carrier.end);
  across_.resize(chain.size());
  third_.resize(chain.size());
  for (std::size_t d = 0; d < chain.size(); ++d) {
    across_[d] = at(axes_, chain[d]).head<3>().dot(across_W);
    third_[d] = at(axes_, chain[d]).head<3>().dot(third_W);
  }
  Transform(carrier.end, across_);
  Transform(carrier.end, third_);
  double a = 0, b = 0, c = 0;
  for (std::size_t d = 0; d < chain.size(); ++d) {
    a += across_[d] * across_[d] / pivot(chain[d]);
    b += across_[d] * third_[d] / pivot(chain[d]);
    c += third_[d] * third_[d] / pivot(chain[d]);
  }
  return carrier.spin_W.squaredNorm() * std::max(0.0, a * c - b * b);
}

double Forest::SwingRate_rad_s() {
  for (Node& node : nodes_) node.square_m2 = node.arm_W.squaredNorm();
  double most = 0;
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    const Node& node = nodes_[n];
    if (node.parent == kNone) continue;
    Node& parent = at(nodes_, node.parent);
    parent.load += node.load;
    if (parent.model != nullptr)
      parent.square_m2 = std::max(parent.square_m2, (node.model->p_RJ - parent.model->p_RJ).squaredNorm());
    const double inertia = node.rigid->mass_kg * node.arm_W.squaredNorm() +
                           node.rigid->inertia_kg_m2.trace() / 3 + ArmatureOf(node);
    most = std::max(most, node.load.squaredNorm() * node.square_m2 / (inertia * inertia));
  }
  return std::sqrt(4.0 / 3 * std::sqrt(most));
}

}  // namespace coopdyn
