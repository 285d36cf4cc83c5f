// SPDX-License-Identifier: MIT
// Contacts of an island with limbs: their normal and friction rows.
#include <algorithm>
#include <cmath>
#include <utility>

#include "server/physics/limb_solver.h"

namespace coopdyn {

void LimbSolver::Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a,
                      const Actor* b, std::uint32_t index_b, double dt_s, bool measured) {
  const auto channels = [this](std::uint32_t thing) {
    const int member = thing < member_of_.size() ? member_of_[thing] : kNone;
    return member == kNone ? std::span<const ChannelState>()
                           : members_[static_cast<std::size_t>(member)].channels;
  };
  for (const FoundContact& contact : found) {
    int node_a = NodeOf(index_a, *contact.a);
    int node_b = b == nullptr ? kNone : NodeOf(index_b, *contact.b);
    if (node_a == kNone && node_b == kNone) continue;
    const ContactSide of_b =
        b == nullptr ? ContactSide() : ContactSide{b, node_b != kNone, channels(index_b)};
    const auto surface = SurfaceOf(contact, {&a, node_a != kNone, channels(index_a)}, of_b, settings_, dt_s);
    if (!surface) continue;
    if (surface->swapped) std::swap(node_a, node_b);
    touches_ = true;
    const std::size_t first_row = rows_.size();
    const std::span<const Vector3> directions = AddContact(*surface, node_a, node_b, dt_s);
    if (!measured) continue;
    measured_.push_back({index_a, b == nullptr ? MeasuredContact::kFloor : index_b, contact.a, contact.b,
                         contact.point.p_W, contact.point.n_W});
    if (surface->may_turn && !turning_.empty() && turning_.back().row == first_row + 1)
      turning_.back().rubbing = static_cast<int>(rubbing_.size());
    Rubbing& rubbing = rubbing_.emplace_back();
    rubbing.first_row = first_row;
    rubbing.count = directions.size();
    for (std::size_t i = 0; i < directions.size(); ++i)
      rubbing.directions[i] = surface->swapped ? -directions[i] : directions[i];
  }
}

void LimbSolver::AddWrench(int node, const Vector3& p_W, const Vector3& torque, const Vector3& force,
                           Row& row) {
  if (node == kNone || forest_.EndOf(node) == kNone) return;
  const int end = forest_.EndOf(node);
  Row::Part& part = row.parts[row.part_count++];
  part = {end, jacobian_.size()};
  const auto length = static_cast<std::size_t>(forest_.ChainLength(end));
  jacobian_.resize(part.from + length);
  forest_.AddWrench(node, p_W, torque, force, std::span(jacobian_).subspan(part.from, length));
}

double LimbSolver::RateOf(const Row& row, std::span<const double> rates) const {
  double rate = 0;
  for (const Row::Part& part : row.all()) {
    const double* J = jacobian_.data() + part.from;
    for (const int dof : forest_.Chain(part.end)) rate += *J++ * rates[static_cast<std::size_t>(dof)];
  }
  return rate;
}

// Makes the same rows as ODE's contact joint.
std::span<const Vector3> LimbSolver::AddContact(const Surface& touch, int node_a, int node_b, double dt_s) {
  const dContact& contact = touch.contact;
  const Vector3 p(contact.geom.pos), n(contact.geom.normal), none = Vector3::Zero();
  const dSurfaceParameters& surface = contact.surface;
  std::size_t count = 0;
  const auto add = [&](const Vector3& direction) -> Row& {
    directions_[count++] = direction;
    Row& row = rows_.emplace_back();
    row.softness = kCfm / dt_s;
    AddWrench(node_a, p, none, direction, row);
    AddWrench(node_b, p, none, -direction, row);
    return row;
  };
  const int normal = static_cast<int>(rows_.size());
  Row& push = add(n);
  const double approach = (surface.mode & dContactMotionN) != 0 ? surface.motionN : 0;
  if ((surface.mode & dContactSoftCFM) != 0) {
    push.softness = surface.soft_cfm / dt_s;
    push.target = surface.soft_erp / dt_s * contact.geom.depth + approach;
  } else {
    push.target = std::min(kErp / dt_s * contact.geom.depth + approach, kMaxPushOut_m_s);
  }
  push.lower = 0;
  if ((surface.mode & dContactBounce) != 0) {
    const double outgoing = RateOf(push, forest_.rates()) - approach;
    if (-outgoing > surface.bounce_vel) {
      push.target = std::max(push.target, approach - surface.bounce * outgoing);
    }
  }
  dVector3 first, second;
  if ((surface.mode & dContactFDir1) != 0) {
    std::copy_n(contact.fdir1, 3, first);
  } else {
    dPlaneSpace(contact.geom.normal, first, second);
  }
  const Vector3 along(first);
  const auto rub = [&](const Vector3& direction, double friction, bool by_load, double motion) {
    if (friction <= 0) return;
    Row& row = add(direction);
    row.target = motion;
    if (by_load && std::isfinite(friction)) {
      row.normal = normal;
      row.friction = friction;
    } else {
      row.lower = -friction * dt_s;
      row.upper = friction * dt_s;
    }
  };
  const bool two = (surface.mode & dContactMu2) != 0;
  const double mu2 = two ? surface.mu2 : surface.mu;
  const bool turns = touch.may_turn && surface.mu > 0 && mu2 == surface.mu && std::isfinite(mu2);
  if (turns) turning_.push_back({rows_.size(), kNone});
  rub(along, surface.mu, (surface.mode & dContactApprox1_1) != 0,
      (surface.mode & dContactMotion1) != 0 ? surface.motion1 : 0);
  rub(n.cross(along), mu2, (surface.mode & dContactApprox1_2) != 0, 0);
  if (Row& across = rows_.back(); count == 3 && across.normal != kNone) across.slip_m_s = touch.slip_m_s;
  if ((surface.mode & dContactRolling) != 0) {
    const auto hold = [&](const Vector3& axis, double arm_m) {
      if (arm_m <= 0) return;
      Row& row = rows_.emplace_back();
      row.softness = kCfm / dt_s;
      AddWrench(node_a, p, axis, none, row);
      AddWrench(node_b, p, -axis, none, row);
      row.normal = normal;
      row.friction = arm_m;
    };
    hold(along, surface.rho);
    hold(n.cross(along), surface.rho2);
    hold(n, surface.rhoN);
  }
  return std::span(directions_).first(count);
}

void LimbSolver::TurnFriction() {
  constexpr double kStill_m_s = 1e-6;
  for (const Turning& turning : turning_) {
    const auto i = static_cast<Eigen::Index>(turning.row), k = i + 1;
    const double u = A_.row(i).dot(impulses_) - b_[i], w = A_.row(k).dot(impulses_) - b_[k];
    const double speed = std::sqrt(u * u + w * w);
    if (!(speed > kStill_m_s)) continue;
    const double c = u / speed, s = w / speed;
    const auto turn = [c, s](auto& first, auto& second) {
      const auto along = first;
      first = c * along + s * second;
      second = c * second - s * along;
    };
    const Row &one = rows_[turning.row], &other = rows_[turning.row + 1];
    for (std::size_t part = 0; part < one.part_count; ++part) {
      const std::size_t from = one.parts[part].from, of = other.parts[part].from;
      const auto length = static_cast<std::size_t>(forest_.ChainLength(one.parts[part].end));
      for (std::vector<double>* values : {&jacobian_, &transformed_, &divided_}) {
        for (std::size_t d = 0; d < length; ++d) turn((*values)[from + d], (*values)[of + d]);
      }
    }
    for (Eigen::Index j = 0; j < A_.cols(); ++j) turn(A_(i, j), A_(k, j));
    for (Eigen::Index j = 0; j < A_.rows(); ++j) turn(A_(j, i), A_(j, k));
    turn(b_[i], b_[k]);
    if (turning.rubbing == kNone) continue;
    std::array<Vector3, 3>& directions = rubbing_[static_cast<std::size_t>(turning.rubbing)].directions;
    turn(directions[1], directions[2]);
  }
}

}  // namespace coopdyn
