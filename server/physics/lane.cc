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

// Nearer to the ground than this a wheel counts as touching it.
constexpr double kTouching_m = 1e-4;

void Copy(dVector3& to, const Vector3& from) {
  std::copy_n(from.data(), 3, to);
}

/// Velocity of the point `p` of a body.
Vector3 PointVelocity(const BodyState& body, const Vector3& p) {
  return body.v_WB + body.w_WB.cross(p - body.p_WB);
}

Vector3 PointVelocity(const Actor* actor, const Part* part, const Vector3& p) {
  if (actor == nullptr) return Vector3::Zero();
  return PointVelocity(actor->bodies[static_cast<std::size_t>(part->body)], p);
}

}  // namespace

Lane::Lane(const Things& things, const Settings& settings)
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
  // Another mechanism may lie where the one lay whose masses they have.
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
  dWorldSetGravity(world, 0, 0, -settings_.gravity_m_s2);
  dWorldSetERP(world, kErp);
  dWorldSetCFM(world, kCfm);
  dWorldSetContactMaxCorrectingVel(world, kMaxPushOut_m_s);
  dWorldSetQuickStepNumIterations(world, kQuickIterations);
  dWorldSetQuickStepW(world, 1.0);
  loaded_.clear();
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
    SetMass(body, of, false);
    const Quaternion& q = of.X_RB.q;
    const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
    dBodySetPosition(body, of.X_RB.p.x(), of.X_RB.p.y(), of.X_RB.p.z());
    dBodySetQuaternion(body, quaternion);
  }
  if (mechanism != nullptr) {
    loan.loaded = mechanism;
    if (mechanism->fixed_base) dBodySetKinematic(loan.bodies.front());
    for (const Joint& of : mechanism->joints) {
      dJointID joint = MakeJoint(world_.get(), *of.model, loan.bodies);
      loan.joints.push_back(joint);
      if (of.channel < 0) continue;
      const auto channel = static_cast<std::size_t>(of.channel);
      if (loan.motors.size() <= channel) loan.motors.resize(channel + 1);
      loan.motors[channel] = joint;
      if (of.board == nullptr) dJointSetHingeParam(joint, dParamFMax, of.max_effort);
    }
    loan.levers.resize(loan.motors.size());
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

void Lane::Load(std::uint32_t thing, const Actor& actor, std::span<const ChannelState> channels,
                std::span<const JointRow> rows, double dt_s) {
  const Mechanism& mechanism = *actor.thing.mechanism;
  Pool& pool = pools_[actor.thing.pool];
  Loan& loan = pool.loans[pool.used++];
  loan_of_[thing] = &loan;
  loaded_.push_back(thing);
  if (loan.loaded != &mechanism) {
    SetMass(loan.bodies.front(), mechanism.bodies.front(), mechanism.one_body() && mechanism.planar());
    loan.loaded = &mechanism;
  }
  loan.channels = channels;
  for (std::size_t i = 0; i < loan.motors.size(); ++i) {
    if (loan.motors[i] != nullptr && rows.empty())
      dJointSetHingeParam(loan.motors[i], dParamVel, channels[i].setpoint.reference);
  }
  for (std::size_t k = 0; k < loan.bodies.size(); ++k) {
    Write(loan.bodies[k], actor.bodies[k]);
    dBodyEnable(loan.bodies[k]);
  }
  for (std::size_t i = 0; i < loan.joints.size(); ++i) {
    const Joint& joint = mechanism.joints[i];
    if (joint.control >= 0) {
      loan.levers[static_cast<std::size_t>(joint.channel)] = LeverOf(loan.joints[i]);
      Drive(loan.joints[i], rows[static_cast<std::size_t>(joint.control)], dt_s);
    } else if (joint.channel < 0) {
      if (joint.model->is_resisted()) Resist(loan.joints[i], *joint.model, dt_s);
    } else if (!rows.empty()) {
      const auto channel = static_cast<std::size_t>(joint.channel);
      dJointSetHingeParam(loan.joints[i], dParamVel, channels[channel].setpoint.reference);
    }
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
  return RateOf(loan_of_[thing]->joints[joint]);
}

double Lane::JointPosition(std::uint32_t thing, std::size_t joint, double last) const {
  return Unwrap(loan_of_[thing]->joints[joint], last);
}

double Lane::JointEffort(std::uint32_t thing, const Joint& joint) const {
  const auto channel = static_cast<std::size_t>(joint.channel);
  dJointID motor = loan_of_[thing]->motors[channel];
  const dJointFeedback& force = loan_of_[thing]->forces[channel];
  if (joint.board != nullptr) return MeasuredEffort(motor, force, loan_of_[thing]->levers[channel]);
  // A wheel turns about its centre of mass.
  dVector3 axis;
  dJointGetHingeAxis(motor, axis);
  return axis[0] * force.t1[0] + axis[1] * force.t1[1] + axis[2] * force.t1[2];
}

void Lane::Unload() {
  for (const std::uint32_t thing : loaded_) {
    for (dBodyID body : loan_of_[thing]->bodies) dBodyDisable(body);
    loan_of_[thing] = nullptr;
  }
  loaded_.clear();
  for (Pool& pool : pools_) pool.used = 0;
}

// --- contact joints

dBodyID Lane::BodyOf(std::uint32_t thing, const Part& part) const {
  if (thing >= loan_of_.size() || loan_of_[thing] == nullptr) return nullptr;
  if (part.body == 0 && things_.all[thing].mechanism->fixed_base) return nullptr;
  return loan_of_[thing]->bodies[static_cast<std::size_t>(part.body)];
}

void Lane::Attach(dContact& contact, const ContactPoint& point, dBodyID a, dBodyID b, double dt_s) {
  Copy(contact.geom.pos, point.p_W);
  Copy(contact.geom.normal, point.n_W);
  contact.geom.depth = std::max(0.0, point.depth_m);
  if (point.depth_m < 0) {
    // They may come as near as they are, and no nearer.
    contact.surface.mode |= dContactMotionN;
    contact.surface.motionN = point.depth_m / dt_s;
  }
  dJointAttach(dJointCreateContact(world_.get(), contacts_.get(), &contact), a, b);
}

void Lane::JoinParts(const FoundContact& found, const Actor& actor_a, const Actor* actor_b, dBodyID a,
                     dBodyID b, bool flat, double dt_s) {
  const ContactPoint& point = found.point;
  dContact contact{};
  const double restitution = std::max(found.a->restitution, found.b == nullptr ? 0 : found.b->restitution);
  if (restitution > 0 && point.depth_m < 0) return;  // it turns round where it touches
  contact.surface.mu =
      std::min(found.a->friction, found.b == nullptr ? settings_.floor_friction : found.b->friction);
  if (contact.surface.mu > 0) {
    contact.surface.mode = dContactApprox1;
    // The friction pyramid lies along the slip, so that sliding bodies brake alike in every direction.
    const Vector3 slip = PointVelocity(a == nullptr ? nullptr : &actor_a, found.a, point.p_W) -
                         PointVelocity(b == nullptr ? nullptr : actor_b, found.b, point.p_W);
    const Vector3 along = slip - slip.dot(point.n_W) * point.n_W;
    constexpr double kSliding_m_s = 0.01;
    constexpr double kHorizontal = 0.1;
    if (flat && std::abs(point.n_W.z()) < kHorizontal) {
      contact.surface.mode |= dContactFDir1 | dContactMu2;
      contact.surface.mu2 = 0;
      Copy(contact.fdir1, Vector3::UnitZ().cross(point.n_W).normalized());
    } else if (along.squaredNorm() > kSliding_m_s * kSliding_m_s) {
      contact.surface.mode |= dContactFDir1;
      Copy(contact.fdir1, along.normalized());
    }
  }
  if (restitution > 0) {
    // Slower than gravity makes it in two steps, it stays.
    contact.surface.mode |= dContactBounce;
    contact.surface.bounce = restitution;
    contact.surface.bounce_vel = 2 * settings_.gravity_m_s2 * dt_s;
  }
  Attach(contact, point, a, b, dt_s);
}

void Lane::JoinWheel(const FoundContact& found, const Actor& robot, std::uint32_t index, dBodyID body,
                     dBodyID other, int sign, double dt_s) {
  const Part& wheel = *(found.wheel == 0 ? found.a : found.b);
  const Part* ground = found.wheel == 0 ? found.b : found.a;
  const OneBodyDrive& drive = *robot.thing.mechanism->drive;
  const std::size_t side = static_cast<std::size_t>(wheel.wheel);
  ContactPoint point = found.point;
  point.n_W *= sign;  // towards the robot
  // The rolling direction at mid-step: the robot turns on while it rolls.
  const BodyState& state = robot.bodies[0];
  const double half_turn = state.w_WB.z() * dt_s / 2;
  const double c = std::cos(half_turn), s = std::sin(half_turn);
  const std::array<double, 9>& R = state.R_WB;
  const Vector3 axle(c * R[1] - s * R[4], s * R[1] + c * R[4], R[7]);
  dContact contact{};
  contact.surface.mode = dContactFDir1 | dContactMotion1 | dContactMu2;
  Copy(contact.fdir1, axle.cross(point.n_W).normalized());
  contact.surface.motion1 = drive.SpeedsOf(loan_of_[index]->channels)[side] * drive.wheels.radius_m;
  if (robot.thing.mechanism->planar()) {
    // It always stands as at rest. One wheel's row holds it sideways for both.
    contact.surface.mu = drive.drive_n[side];
    contact.surface.mu2 = side == 0 ? drive.sideways_n : 0;
  } else {
    const double friction =
        std::min(wheel.friction, ground == nullptr ? settings_.floor_friction : ground->friction);
    contact.surface.mode |= dContactApprox1_2;
    contact.surface.mu2 = friction;
    if (drive.stalls && point.depth_m > -kTouching_m) {
      contact.surface.mu = drive.drive_n[side];  // the motor's, whatever the load
    } else {
      contact.surface.mode |= dContactApprox1_1;
      contact.surface.mu = friction;
    }
  }
  Attach(contact, point, body, other, dt_s);
}

void Lane::Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a, const Actor* b,
                std::uint32_t index_b, double dt_s) {
  const auto is_one = [](const Actor& actor) { return actor.thing.mechanism->one_body(); };
  // Robots side by side, or along a wall, do not lift each other: friction acts in the plane only. Else a
  // crowd would climb up on itself, by what is an artefact of stepping.
  const bool flat = b != nullptr && a.thing.robot >= 0 && (b->thing.robot >= 0 || b->thing.body_count() == 0);
  for (const FoundContact& contact : found) {
    dBodyID body_a = BodyOf(index_a, *contact.a);
    dBodyID body_b = b == nullptr ? nullptr : BodyOf(index_b, *contact.b);
    if (body_a == nullptr && body_b == nullptr) continue;
    const bool a_rolls = contact.wheel == 0 && is_one(a) && body_a != nullptr;
    const bool b_rolls = contact.wheel == 1 && is_one(*b) && body_b != nullptr;
    if (a_rolls && a.thing.mechanism->drive) {
      JoinWheel(contact, a, index_a, body_a, body_b, 1, dt_s);
    } else if (b_rolls && b->thing.mechanism->drive) {
      JoinWheel(contact, *b, index_b, body_b, body_a, -1, dt_s);
    } else {
      JoinParts(contact, a, b, body_a, body_b, flat, dt_s);
    }
  }
}

}  // namespace coopdyn
