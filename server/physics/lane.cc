// SPDX-License-Identifier: MIT
#include "server/physics/lane.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "server/base/mutex.h"
#include "server/physics/islands.h"
#include "server/physics/ode_setup.h"

namespace coopdyn {

namespace {

// A contact that sinks in is pushed out by this share of its depth in a substep, but never faster than
// kMaxPushOut: 0.4 keeps wheels at their radius and hinges together at every step size; the cap is what makes
// impacts not bounce.
constexpr double kErp = 0.4;
constexpr double kMaxPushOut_m_s = 0.1;
// Softness (m/s per N·s): shares a load among redundant contacts; small enough that nothing creeps on a
// slope.
constexpr double kCfm = 1e-6;

// Reachable, so that it does not count as leaked.
void KeepForever(dThreadingImplementationID threading) {
  static Mutex mutex;
  static std::vector<dThreadingImplementationID>* const kept = new std::vector<dThreadingImplementationID>;
  const MutexLock lock(mutex);
  kept->push_back(threading);
}

void SetMass(dBodyID body, const RigidBody& of, bool planar) {
  Matrix3 I = of.inertia_kg_m2;
  if (planar) {
    // Nothing tilts it.
    constexpr double kUntiltable_kg_m2 = 1e6;
    I.setZero();
    I.diagonal() = Vector3(kUntiltable_kg_m2, kUntiltable_kg_m2, of.inertia_kg_m2(2, 2));
  }
  dMass mass;
  dMassSetParameters(&mass, of.mass_kg, 0, 0, 0, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  dBodySetMass(body, &mass);
}

/// Gives a body without shapes exactly this state. ODE's setters would round its orientation.
void Write(dBodyID body, const BodyState& state) {
  std::copy_n(state.p_WB.data(), 3, const_cast<dReal*>(dBodyGetPosition(body)));
  std::copy_n(state.q_WB.data(), 4, const_cast<dReal*>(dBodyGetQuaternion(body)));
  dReal* R = const_cast<dReal*>(dBodyGetRotation(body));
  for (std::size_t row = 0; row < 3; ++row) std::copy_n(state.R_WB.data() + 3 * row, 3, R + 4 * row);
  dBodySetLinearVel(body, state.v_WB.x(), state.v_WB.y(), state.v_WB.z());
  dBodySetAngularVel(body, state.w_WB.x(), state.w_WB.y(), state.w_WB.z());
}

}  // namespace

Lane::Lane(const Things& things, const Settings& settings)
    : things_(things), settings_(settings), sizes_(things.pools.size()), slot_of_(things.first_static) {
  Build();
}

Lane::~Lane() {
  if (broken_) KeepForever(threading_.release());
}

void Lane::Reset() {
  KeepForever(threading_.release());
  Build();
}

void Lane::Fit() {
  slot_of_.assign(things_.first_static, nullptr);
  const bool same = std::ranges::equal(pools_, things_.pools, {}, &Pool::mechanism);
  if (!same) {
    sizes_.assign(things_.pools.size(), 0);
    if (broken_) KeepForever(threading_.release());
    Build();
    return;
  }
  // Another mechanism may lie where the one lay whose masses they have.
  for (Slot& slot : pools_.front().slots) slot.loaded = nullptr;
}

void Lane::Build() {
  EnsureOde();
  contacts_.reset();
  world_.reset();
  broken_ = false;
  threading_.reset(dThreadingAllocateSelfThreadedImplementation());
  world_.reset(dWorldCreate());
  dWorldID world = world_.get();
  dWorldSetStepThreadingImplementation(world, dThreadingImplementationGetFunctions(threading_.get()),
                                       threading_.get());
  contacts_.reset(dJointGroupCreate(0));
  dWorldSetGravity(world, 0, 0, -settings_.gravity_m_s2);
  dWorldSetERP(world, kErp);
  dWorldSetCFM(world, kCfm);
  dWorldSetContactMaxCorrectingVel(world, kMaxPushOut_m_s);
  dWorldSetQuickStepNumIterations(world, kQuickIterations);
  dWorldSetQuickStepW(world, 1.0);
  loaded_.clear();
  std::fill(slot_of_.begin(), slot_of_.end(), nullptr);
  // Always pool by pool, so that the order of bodies in ODE does not depend on how a lane has grown.
  pools_.clear();
  pools_.resize(things_.pools.size());
  for (std::size_t pool = 0; pool < pools_.size(); ++pool) {
    pools_[pool].mechanism = things_.pools[pool];
    for (std::size_t i = 0; i < sizes_[pool]; ++i)
      pools_[pool].slots.push_back(MakeSlot(things_.pools[pool]));
  }
}

Lane::Slot Lane::MakeSlot(const Mechanism* mechanism) {
  Slot slot;
  for (std::size_t k = 0; k < (mechanism == nullptr ? 1 : mechanism->bodies.size()); ++k) {
    dBodyID body = dBodyCreate(world_.get());
    dBodySetAutoDisableFlag(body, 0);
    slot.bodies.push_back(body);
    if (mechanism == nullptr) continue;
    const RigidBody& of = mechanism->bodies[k];
    SetMass(body, of, false);
    const Quaternion& q = of.X_RB.q;
    const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
    dBodySetPosition(body, of.X_RB.p.x(), of.X_RB.p.y(), of.X_RB.p.z());
    dBodySetQuaternion(body, quaternion);
  }
  if (mechanism != nullptr) {
    slot.loaded = mechanism;
    for (const Hinge& of : mechanism->hinges) {
      dJointID hinge = dJointCreateHinge(world_.get(), nullptr);
      dJointAttach(hinge, slot.bodies[static_cast<std::size_t>(of.child)],
                   slot.bodies[static_cast<std::size_t>(of.parent)]);  // so that its rate is the child's
      dJointSetHingeAnchor(hinge, of.p_R.x(), of.p_R.y(), of.p_R.z());
      dJointSetHingeAxis(hinge, of.axis_R.x(), of.axis_R.y(), of.axis_R.z());
      if (of.channel < 0) continue;
      const auto channel = static_cast<std::size_t>(of.channel);
      if (slot.motors.size() <= channel) slot.motors.resize(channel + 1);
      slot.motors[channel] = hinge;
      dJointSetHingeParam(hinge, dParamFMax, of.max_torque_nm);
    }
    slot.forces = std::make_unique<dJointFeedback[]>(slot.motors.size());
    for (std::size_t i = 0; i < slot.motors.size(); ++i) {
      if (slot.motors[i] != nullptr) dJointSetFeedback(slot.motors[i], &slot.forces[i]);
    }
  }
  for (dBodyID body : slot.bodies) dBodyDisable(body);
  return slot;
}

void Lane::Reserve(std::span<const std::uint32_t> members) {
  std::vector<std::size_t> needed(pools_.size());
  bool grows = false;
  for (const std::uint32_t thing : members) ++needed[things_.all[thing].pool];
  for (std::size_t pool = 0; pool < needed.size(); ++pool) {
    if (needed[pool] <= sizes_[pool]) continue;
    sizes_[pool] = std::max(needed[pool], 2 * sizes_[pool]);
    grows = true;
  }
  if (!grows) return;
  if (broken_) KeepForever(threading_.release());
  Build();
}

void Lane::Load(std::uint32_t thing, const Actor& actor, std::span<const ChannelState> channels) {
  const Mechanism& mechanism = *actor.thing.mechanism;
  Pool& pool = pools_[actor.thing.pool];
  Slot& slot = pool.slots[pool.used++];
  slot_of_[thing] = &slot;
  loaded_.push_back(thing);
  if (slot.loaded != &mechanism) {
    SetMass(slot.bodies.front(), mechanism.bodies.front(), mechanism.one_body() && mechanism.planar());
    slot.loaded = &mechanism;
  }
  slot.channels = channels;
  for (std::size_t i = 0; i < slot.motors.size(); ++i) {
    if (slot.motors[i] != nullptr)
      dJointSetHingeParam(slot.motors[i], dParamVel, channels[i].setpoint.reference);
  }
  for (std::size_t k = 0; k < slot.bodies.size(); ++k) {
    Write(slot.bodies[k], actor.bodies[k]);
    dBodyEnable(slot.bodies[k]);
  }
}

void Lane::Step(Solver solver, double dt_s) {
  broken_ = true;
  if (solver == Solver::kDirect) {
    dWorldStep(world_.get(), dt_s);
  } else {
    dWorldQuickStep(world_.get(), dt_s);
  }
  broken_ = false;
  dJointGroupEmpty(contacts_.get());
}

BodyState Lane::Read(std::uint32_t thing, std::size_t index) const {
  dBodyID body = slot_of_[thing]->bodies[index];
  BodyState state;
  const dReal* R = dBodyGetRotation(body);
  std::copy_n(dBodyGetPosition(body), 3, state.p_WB.data());
  std::copy_n(dBodyGetQuaternion(body), 4, state.q_WB.begin());
  for (std::size_t row = 0; row < 3; ++row) std::copy_n(R + 4 * row, 3, state.R_WB.begin() + 3 * row);
  std::copy_n(dBodyGetLinearVel(body), 3, state.v_WB.data());
  std::copy_n(dBodyGetAngularVel(body), 3, state.w_WB.data());
  return state;
}

double Lane::HingeRate(std::uint32_t thing, const Hinge& hinge) const {
  return dJointGetHingeAngleRate(slot_of_[thing]->motors[static_cast<std::size_t>(hinge.channel)]);
}

double Lane::HingeEffort(std::uint32_t thing, const Hinge& hinge) const {
  const auto channel = static_cast<std::size_t>(hinge.channel);
  dVector3 axis;
  dJointGetHingeAxis(slot_of_[thing]->motors[channel], axis);
  const dJointFeedback& force = slot_of_[thing]->forces[channel];
  return axis[0] * force.t1[0] + axis[1] * force.t1[1] + axis[2] * force.t1[2];
}

void Lane::Unload() {
  for (const std::uint32_t thing : loaded_) {
    for (dBodyID body : slot_of_[thing]->bodies) dBodyDisable(body);
    slot_of_[thing] = nullptr;
  }
  loaded_.clear();
  for (Pool& pool : pools_) pool.used = 0;
}

}  // namespace coopdyn
