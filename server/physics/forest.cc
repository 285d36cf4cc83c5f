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

}  // namespace

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

Forest::Inertia Forest::InertiaOf(const Node& node, const Vector3& p_W) {
  const Vector3 c = node.state.p_WB - p_W;
  const Matrix3 R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(node.state.R_WB.data());
  const double mass = node.rigid->mass_kg;
  return {mass, mass * c,
          R * node.rigid->inertia_kg_m2 * R.transpose() +
              mass * (c.squaredNorm() * Matrix3::Identity() - c * c.transpose())};
}

void Forest::Begin(double gravity_m_s2, double dt_s) {
  gravity_m_s2_ = gravity_m_s2;
  dt_s_ = dt_s;
  for (Node& node : nodes_) node.subtree = node.inertia = InertiaOf(node, node.origin);
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
        const Vector3 p = Carried(node, node.model->p_RJ) - node.origin;
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

double Forest::SwingRate_rad_s() const {
  // By node: the force that carries it and all that hangs on it, and how far from its joint that works.
  std::vector<Vector3> forces(nodes_.size(), Vector3::Zero());
  std::vector<double> levers(nodes_.size(), 0.0);
  double most = 0;
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    const Node& node = nodes_[n];
    forces[n] += (node.inertia * node.bias + CrossForce(node.velocity, node.momentum)).tail<3>();
    if (node.parent == kNone) continue;
    const auto parent = static_cast<std::size_t>(node.parent);
    forces[parent] += forces[n];
    const Vector3 joint = Carried(node, node.model->p_RJ);
    if (nodes_[parent].model != nullptr) {
      const Node& above = nodes_[parent];
      levers[parent] = std::max(levers[parent], (joint - Carried(above, above.model->p_RJ)).norm());
    }
    const Vector3 c = node.state.p_WB - joint;
    const double lever = std::max(levers[n], c.norm());
    const double inertia = node.rigid->mass_kg * c.squaredNorm() + node.rigid->inertia_kg_m2.trace() / 3;
    most = std::max(most, 4.0 / 3 * forces[n].norm() * lever / inertia);
  }
  return std::sqrt(most);
}

}  // namespace coopdyn
