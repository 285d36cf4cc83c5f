// SPDX-License-Identifier: MIT
// What of a substep goes through ODE.
#include <algorithm>
#include <cmath>

#include "server/physics/engine.h"
#include "server/physics/freeze.h"
#include "server/physics/rest.h"

namespace coopdyn {

namespace {

// A robot of one body is held at its height rather than dropped and caught: its floor contacts exist from
// this gap on.
constexpr double kFloorGap_m = 2e-3;

/// Puts a planar robot back into its plane, upright.
void Flatten(BodyState& body, double rest_z_m) {
  const double norm = std::hypot(body.q_WB[0], body.q_WB[3]);
  const double w = body.q_WB[0] / norm, z = body.q_WB[3] / norm;
  const double c = w * w - z * z, s = 2 * w * z;
  body.q_WB = {w, 0, 0, z};
  body.R_WB = {c, -s, 0, s, c, 0, 0, 0, 1};
  body.p_WB.z() = rest_z_m;
  body.v_WB.z() = 0;
  body.w_WB = {0, 0, body.w_WB.z()};
}

}  // namespace

void Engine::TellOde() {
  for (std::size_t i = 0; i < ode_->bodies.size(); ++i) {
    if (ode_->bodies[i] != nullptr) WriteBody(ode_->bodies[i], state_.bodies[i]);
  }
  for (std::size_t i = 0; i < dynamic_count(); ++i) {
    Owner& owner = ode_->owners[i];
    const BodyState& body = first_body(i);
    owner.frozen = body.frozen();
    if (owner.robot >= 0) state_.robots[static_cast<std::size_t>(owner.robot)].frozen = owner.frozen;
    if (owner.one_body != nullptr) continue;
    if (owner.robot < 0) {
      Part& part = ode_->parts[static_cast<std::size_t>(owner.first_part)];
      part.half_m = HalfExtents(part.shape, body.orientation());
      broad_phase_->MoveObject(*ode_, i);
    }
    if (body.sleep_counter >= kAsleep) Hold(*ode_, owner);
  }
}

void Engine::SetMotors() {
  for (std::size_t i = 0; i < setpoints_.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      dJointID hinge = ode_->motors[i][side];
      if (hinge != nullptr) dJointSetHingeParam(hinge, dParamVel, setpoints_[i][side]);
    }
  }
}

void Engine::Touch(double dt_s) {
  while (!FindAllContacts(dt_s)) Sort();
}

bool Engine::FindAllContacts(double dt_s) {
  OdeWorld& ode = *ode_;
  const std::size_t count = dynamic_count();
  ode.FreeSlots();
  for (std::size_t i = first_robot(); i < count; ++i) {
    Owner& owner = ode.owners[i];
    if (owner.one_body != nullptr && (in_ode_[i] || near_[i])) ode.TakeSlot(owner, first_body(i));
  }
  found_.clear();
  found_ends_.clear();
  bool settled = true;
  for (const auto& [a, b] : pairs_) {
    const std::size_t before = found_.size();
    const double margin_m = travel_m_[a] + (b < count ? travel_m_[b] : 0);
    FindContacts(ode, ode.owners[a], ode.owners[b], margin_m, found_);
    found_ends_.push_back(found_.size());
    if (found_.size() == before) continue;
    for (const std::uint32_t sleeper : {a, b}) {
      if (sleeper >= count || first_body(sleeper).sleep_counter != kAsleep) continue;
      Wake(sleeper, dt_s);
      settled = false;
    }
  }
  return settled;
}

void Engine::Wake(std::size_t owner, double dt_s) {
  const Owner& info = ode_->owners[owner];
  for (BodyState& body : BodiesOf(info)) body.sleep_counter = 0;
  moves_[owner] = 1;
  if (info.robot >= 0) PlanRobot(static_cast<std::size_t>(info.robot), dt_s);
}

void Engine::AddJoints(double dt_s) {
  OdeWorld& ode = *ode_;
  const std::size_t count = dynamic_count();
  const JointMaker joints{ode, setpoints_, scene_.floor.friction, dt_s};
  std::vector<FoundContact>& floor = floor_found_;
  for (const std::uint32_t i : active_) {
    const Owner& owner = ode.owners[i];
    const double gap_m =
        owner.one_body == nullptr ? 0 : kFloorGap_m + dt_s * std::abs(first_body(i).v_WB.z());
    floor.clear();
    FindFloorContacts(ode, owner, gap_m, floor);
    islands_.AddRows(i, joints.Join(floor, owner, nullptr));
  }
  std::size_t first = 0;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const std::span<const FoundContact> contacts(found_.data() + first, found_ends_[k] - first);
    first = found_ends_[k];
    if (contacts.empty()) continue;
    const auto [a, b] = pairs_[k];
    const bool in_a = in_ode_[a], in_b = b < count && in_ode_[b];
    if (!in_a && !in_b) continue;
    islands_.AddRows(in_a ? a : b, joints.Join(contacts, ode.owners[a], &ode.owners[b]));
    if (in_a && in_b) islands_.Join(a, b);
  }
}

void Engine::RunOde(double dt_s) {
  OdeWorld& ode = *ode_;
  for (const std::uint32_t i : active_) {
    const Owner& owner = ode.owners[i];
    if (owner.one_body != nullptr) {
      ode.LoadSlot(owner, first_body(i));
    } else {
      for (int k = 0; k < owner.body_count; ++k) {
        dBodyEnable(ode.bodies[static_cast<std::size_t>(owner.first_body + k)]);
      }
    }
  }
  islands_.Reset(ode, active_);
  dRandSetSeed(static_cast<unsigned long>(state_.solver_seed));
  AddJoints(dt_s);
  Solve(ode, islands_, active_, dt_s);
  dJointGroupEmpty(ode.contacts.get());
  state_.solver_seed = dRandGetSeed();
  for (const std::uint32_t i : active_) ReadOwner(i, dt_s);
  ode.FreeSlots();
}

void Engine::ReadOwner(std::size_t index, double dt_s) {
  const Owner& owner = ode_->owners[index];
  const std::span<BodyState> bodies = BodiesOf(owner);
  const auto body_of = [&](std::size_t k) {
    return owner.one_body != nullptr ? ode_->slots[static_cast<std::size_t>(owner.slot)].body
                                     : ode_->bodies[static_cast<std::size_t>(owner.first_body) + k];
  };
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodyState now = ReadBody(body_of(k));
    if (const auto why = WhyInsane(now)) {
      Freeze(index, *why);
      return;
    }
  }
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const std::uint64_t counter = bodies[k].sleep_counter;
    bodies[k] = ReadBody(body_of(k));
    bodies[k].sleep_counter = counter;
  }
  if (owner.one_body != nullptr && owner.one_body->planar) Flatten(bodies.front(), owner.rest_z_m);
  if (owner.robot >= 0) {
    ReadWheels(owner, dt_s);
  } else {
    Part& part = ode_->parts[static_cast<std::size_t>(owner.first_part)];
    part.half_m = HalfExtents(part.shape, bodies.front().orientation());
    broad_phase_->MoveObject(*ode_, index);
  }
}

void Engine::ReadWheels(const Owner& owner, double dt_s) {
  const std::size_t robot = static_cast<std::size_t>(owner.robot);
  RobotState& state = state_.robots[robot];
  for (std::size_t side = 0; side < 2; ++side) {
    double rate_rad_s = 0;
    if (owner.one_body == nullptr) {
      dJointID hinge = ode_->motors[robot][side];
      if (hinge != nullptr) rate_rad_s = dJointGetHingeAngleRate(hinge);
    } else if (owner.one_body->has_wheels) {
      rate_rad_s = setpoints_[robot][side];
      if (owner.one_body->stalls) {
        // The wheel grips: it turns as the floor passes under it.
        const BodyState& body = first_body(first_robot() + robot);
        const Vector3 ahead(body.R_WB[0], body.R_WB[3], body.R_WB[6]);
        const double b = owner.one_body->wheels.half_track_m;
        const Vector3 arm_B = Vector3(0, side == 0 ? b : -b, 0) - owner.one_body->p_RB;
        const Vector3 arm = body.orientation() * arm_B;
        rate_rad_s = (body.v_WB + body.w_WB.cross(arm)).dot(ahead) / owner.one_body->wheels.radius_m;
      }
    }
    state.wheel_angle_rad[side] += rate_rad_s * dt_s;
    state.wheel_speed_rad_s[side] += rate_rad_s * share_;
  }
}

}  // namespace coopdyn
