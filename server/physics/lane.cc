// SPDX-License-Identifier: MIT
#include "server/physics/lane.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "server/base/mutex.h"
#include "server/physics/islands.h"
#include "server/physics/ode.h"

namespace coopdyn {

namespace {

// Keeps `threading` reachable, so that it does not count as leaked.
void KeepForever(dThreadingImplementationID threading) {
  static Mutex mutex;
  static std::vector<dThreadingImplementationID>* const kept = new std::vector<dThreadingImplementationID>;
  const MutexLock lock(mutex);
  kept->push_back(threading);
}

void SetMass(dBodyID body, const RigidBody& of) {
  const Matrix3& I = of.inertia_kg_m2;
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

/// Makes a wheel's axle for a robot at the origin; `bodies`: by link.
dJointID MakeHinge(dWorldID world, const JointModel& of, const std::vector<dBodyID>& bodies) {
  dJointID joint = dJointCreateHinge(world, nullptr);
  // The child is first, so that the rate is the child's.
  dJointAttach(joint, bodies[static_cast<std::size_t>(of.child)],
               bodies[static_cast<std::size_t>(of.parent)]);
  dJointSetHingeAnchor(joint, of.p_RJ.x(), of.p_RJ.y(), of.p_RJ.z());
  dJointSetHingeAxis(joint, of.axis_R.x(), of.axis_R.y(), of.axis_R.z());
  return joint;
}

}  // namespace

Lane::Lane(const Things& things, const WorldSettings& settings)
    : things_(things), settings_(settings), sizes_(things.pools.size()), loan_of_(things.first_static) {
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
  loan_of_.assign(things_.first_static, nullptr);
  const bool same = std::ranges::equal(pools_, things_.pools, {}, &Pool::mechanism);
  if (!same) {
    sizes_.assign(things_.pools.size(), 0);
    if (broken_) KeepForever(threading_.release());
    Build();
    return;
  }
  // A new mechanism may have the address of the old one whose masses the bodies have.
  for (Loan& loan : pools_.front().loans) loan.loaded = nullptr;
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
  const Vector3& g_W = settings_.g_W;
  dWorldSetGravity(world, g_W.x(), g_W.y(), g_W.z());
  dWorldSetERP(world, kErp);
  dWorldSetCFM(world, kCfm);
  dWorldSetContactMaxCorrectingVel(world, kMaxPushOut_m_s);
  dWorldSetQuickStepNumIterations(world, kQuickIterations);
  dWorldSetQuickStepW(world, 1.0);
  loaded_.clear();
  measured_.clear();
  feedback_.clear();
  std::fill(loan_of_.begin(), loan_of_.end(), nullptr);
  // Always pool by pool, so that the order of bodies in ODE does not depend on how a lane has grown.
  pools_.clear();
  pools_.resize(things_.pools.size());
  for (std::size_t pool = 0; pool < pools_.size(); ++pool) {
    pools_[pool].mechanism = things_.pools[pool];
    for (std::size_t i = 0; i < sizes_[pool]; ++i)
      pools_[pool].loans.push_back(MakeLoan(things_.pools[pool]));
  }
}

Lane::Loan Lane::MakeLoan(const Mechanism* mechanism) {
  Loan loan;
  for (std::size_t k = 0; k < (mechanism == nullptr ? 1 : mechanism->bodies.size()); ++k) {
    dBodyID body = dBodyCreate(world_.get());
    dBodySetAutoDisableFlag(body, 0);
    loan.bodies.push_back(body);
    if (mechanism == nullptr) continue;
    const RigidBody& of = mechanism->bodies[k];
    SetMass(body, of);
    const Quaternion& q = of.X_RB.q;
    const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
    dBodySetPosition(body, of.X_RB.p.x(), of.X_RB.p.y(), of.X_RB.p.z());
    dBodySetQuaternion(body, quaternion);
  }
  if (mechanism != nullptr) {
    loan.loaded = mechanism;
    for (const Joint& of : mechanism->joints) {
      dJointID joint = MakeHinge(world_.get(), *of.model, loan.bodies);
      loan.joints.push_back(joint);
      if (of.channel < 0) continue;
      const auto channel = static_cast<std::size_t>(of.channel);
      if (loan.motors.size() <= channel) loan.motors.resize(channel + 1);
      loan.motors[channel] = joint;
      dJointSetHingeParam(joint, dParamFMax, of.max_effort);
    }
    loan.forces = std::make_unique<dJointFeedback[]>(loan.motors.size());
    for (std::size_t i = 0; i < loan.motors.size(); ++i) {
      if (loan.motors[i] != nullptr) dJointSetFeedback(loan.motors[i], &loan.forces[i]);
    }
  }
  for (dBodyID body : loan.bodies) dBodyDisable(body);
  return loan;
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
  Loan& loan = pool.loans[pool.used++];
  loan_of_[thing] = &loan;
  loaded_.push_back(thing);
  if (loan.loaded != &mechanism) {
    SetMass(loan.bodies.front(), mechanism.bodies.front());
    loan.loaded = &mechanism;
  }
  loan.channels = channels;
  for (std::size_t i = 0; i < loan.motors.size(); ++i) {
    if (loan.motors[i] != nullptr)
      dJointSetHingeParam(loan.motors[i], dParamVel, channels[i].setpoint.reference);
  }
  for (std::size_t k = 0; k < loan.bodies.size(); ++k) {
    Write(loan.bodies[k], actor.bodies[k]);
    dBodyEnable(loan.bodies[k]);
  }
}

bool Lane::Step(Solver solver, double dt_s) {
  broken_ = true;
  TakeOdeComplaint();
  if (solver == Solver::kDirect) {
    dWorldStep(world_.get(), dt_s);
  } else {
    dWorldQuickStep(world_.get(), dt_s);
  }
  broken_ = false;
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    measured_[i].force_W = feedback_[i].sign * Vector3(feedback_[i].forces->f1);
  }
  dJointGroupEmpty(contacts_.get());
  return solver == Solver::kIterative || !TakeOdeComplaint();
}

BodyState Lane::Read(std::uint32_t thing, std::size_t index) const {
  dBodyID body = loan_of_[thing]->bodies[index];
  BodyState state;
  const dReal* R = dBodyGetRotation(body);
  std::copy_n(dBodyGetPosition(body), 3, state.p_WB.data());
  std::copy_n(dBodyGetQuaternion(body), 4, state.q_WB.begin());
  for (std::size_t row = 0; row < 3; ++row) std::copy_n(R + 4 * row, 3, state.R_WB.begin() + 3 * row);
  std::copy_n(dBodyGetLinearVel(body), 3, state.v_WB.data());
  std::copy_n(dBodyGetAngularVel(body), 3, state.w_WB.data());
  return state;
}

double Lane::JointRate(std::uint32_t thing, std::size_t joint) const {
  return dJointGetHingeAngleRate(loan_of_[thing]->joints[joint]);
}

double Lane::JointEffort(std::uint32_t thing, std::size_t joint) const {
  const Loan& loan = *loan_of_[thing];
  const Joint& of = loan.loaded->joints[joint];
  // A wheel's centre of mass lies on its axle.
  const dReal* const torque = loan.forces[static_cast<std::size_t>(of.channel)].t1;
  dVector3 axis;
  dJointGetHingeAxis(loan.joints[joint], axis);
  return axis[0] * torque[0] + axis[1] * torque[1] + axis[2] * torque[2];
}

void Lane::Unload() {
  for (const std::uint32_t thing : loaded_) {
    for (dBodyID body : loan_of_[thing]->bodies) dBodyDisable(body);
    loan_of_[thing] = nullptr;
  }
  loaded_.clear();
  measured_.clear();
  feedback_.clear();
  for (Pool& pool : pools_) pool.used = 0;
}

// --- contact joints

dBodyID Lane::BodyOf(std::uint32_t thing, const Part& part) const {
  if (thing >= loan_of_.size() || loan_of_[thing] == nullptr) return nullptr;
  return loan_of_[thing]->bodies[static_cast<std::size_t>(part.body)];
}

void Lane::Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a, const Actor* b,
                std::uint32_t index_b, double dt_s, bool measured) {
  const auto channels = [this](std::uint32_t thing) {
    const Loan* loan = thing < loan_of_.size() ? loan_of_[thing] : nullptr;
    return loan == nullptr ? std::span<const ChannelState>() : loan->channels;
  };
  for (const FoundContact& contact : found) {
    dBodyID body_a = BodyOf(index_a, *contact.a);
    dBodyID body_b = b == nullptr ? nullptr : BodyOf(index_b, *contact.b);
    if (body_a == nullptr && body_b == nullptr) continue;
    const ContactSide of_b =
        b == nullptr ? ContactSide() : ContactSide{b, body_b != nullptr, channels(index_b)};
    auto surface = SurfaceOf(contact, {&a, body_a != nullptr, channels(index_a)}, of_b, settings_, dt_s);
    if (!surface) continue;
    if (surface->swapped) std::swap(body_a, body_b);
    dJointID joint = dJointCreateContact(world_.get(), contacts_.get(), &surface->contact);
    dJointAttach(joint, body_a, body_b);
    if (!measured) continue;
    measured_.push_back({index_a, b == nullptr ? MeasuredContact::kFloor : index_b, contact.a, contact.b,
                         contact.point.p_W, contact.point.n_W});
    // ODE reports the force on its first body, which is never static.
    const bool first_is_a = (body_a != nullptr) != surface->swapped;
    feedback_.push_back({std::make_unique<dJointFeedback>(), first_is_a ? 1.0 : -1.0});
    dJointSetFeedback(joint, feedback_.back().forces.get());
  }
}

}  // namespace coopdyn
