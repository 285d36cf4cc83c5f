// SPDX-License-Identifier: MIT
// The course of a substep, and what needs no ODE. What does is in engine_ode.cc.
#include "server/physics/engine.h"

#include <algorithm>
#include <cmath>

#include "server/physics/freeze.h"
#include "server/physics/ode_setup.h"
#include "server/physics/rest.h"

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
// Fewer robots are not worth waking other threads.
constexpr std::size_t kParallelFrom = 256, kGrain = 128;

BodyState StateAt(const Pose& X_WB) {
  BodyState state;
  state.p_WB = X_WB.p;
  const Quaternion q = X_WB.q.normalized();
  state.q_WB = {q.w(), q.x(), q.y(), q.z()};
  const Matrix3 R = q.toRotationMatrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      state.R_WB[static_cast<std::size_t>(3 * row + column)] = R(row, column);
    }
  }
  return state;
}

}  // namespace

template <typename Work>
void Engine::ForAll(std::size_t count, const Work& work) {
  if (pool_ == nullptr || count < kParallelFrom) {
    work(0, count);
  } else {
    pool_->For(count, kGrain, work);
  }
}

Engine::Engine(const Scene& scene, std::uint64_t solver_seed, WorkerPool* pool) : scene_(scene), pool_(pool) {
  BuildWorld();
  state_.solver_seed = solver_seed & 0xffffffff;  // ODE's generator has 32 bits
  state_.robots.resize(scene.robots.size());
  for (dBodyID body : ode_->bodies) {
    state_.bodies.push_back(body == nullptr ? BodyState{} : ReadBody(body));
  }
  for (const SceneRobot& robot : scene.robots) {
    if (!robot.one_body()) continue;
    state_.bodies[static_cast<std::size_t>(robot.first_body)] =
        StateAt(robot.entry.X_WR * robot.X_BR.Inverse());
  }
  setpoints_.resize(scene.robots.size());
  plans_.resize(scene.robots.size());
  for (std::size_t i = 0; i < dynamic_count(); ++i) first_bodies_.push_back(ode_->owners[i].first_body);
  for (auto* flags : {&moves_, &near_, &in_ode_, &rested_}) flags->resize(dynamic_count());
  travel_m_.resize(dynamic_count());
}

void Engine::BuildWorld() {
  ode_ = BuildOdeWorld(scene_);
  dWorldID world = ode_->world.get();
  dWorldSetERP(world, kErp);
  dWorldSetCFM(world, kCfm);
  dWorldSetContactMaxCorrectingVel(world, kMaxPushOut_m_s);
  dWorldSetQuickStepNumIterations(world, kQuickIterations);
  dWorldSetQuickStepW(world, 1.0);
  broad_phase_ = std::make_unique<BroadPhase>(*ode_);
}

void Engine::Step(Nanoseconds step, int substeps, std::span<const std::array<double, 2>> setpoints) {
  for (std::size_t i = 0; i < setpoints_.size(); ++i) {
    setpoints_[i] = i < setpoints.size() ? setpoints[i] : std::array<double, 2>{};
    state_.robots[i].setpoint_rad_s = setpoints_[i];
    state_.robots[i].wheel_speed_rad_s = {};
  }
  SetMotors();
  share_ = 1.0 / substeps;
  for (int i = 0; i < substeps; ++i) SafeSubstep(step / substeps);
}

void Engine::SafeSubstep(Nanoseconds dt) {
  const std::uint64_t seed = state_.solver_seed;
  while (true) {
    try {
      Substep(dt);
      return;
    } catch (const OdeError& error) {
      // ODE's own memory is not to be trusted after it threw.
      state_.solver_seed = seed;
      ode_->broken = true;
      const std::vector<std::uint32_t> suspects = active_;
      BuildWorld();
      TellOde();
      SetMotors();
      std::size_t fastest = dynamic_count();
      double most = -1;
      for (const std::uint32_t owner : suspects) {
        for (const BodyState& body : BodiesOf(ode_->owners[owner])) {
          if (Violence(body) <= most) continue;
          most = Violence(body);
          fastest = owner;
        }
      }
      if (fastest == dynamic_count()) return;
      Freeze(fastest, error.what());
    }
  }
}

void Engine::Substep(Nanoseconds dt) {
  const double dt_s = ToSeconds(dt);
  active_.clear();
  PlanAll(dt_s);
  if (Sort()) {
    Touch(dt_s);
    RunOde(dt_s);
  }
  AdvanceClosed(dt_s);
  CountRest(dt);
}

void Engine::PlanAll(double dt_s) {
  const std::size_t base = first_robot();
  for (std::size_t i = 0; i < base; ++i) {
    const BodyState& body = first_body(i);
    moves_[i] = body.sleep_counter < kAsleep;
    travel_m_[i] = moves_[i] ? dt_s * body.v_WB.norm() : 0;
  }
  ForAll(plans_.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) PlanRobot(i, dt_s);
  });
}

void Engine::PlanRobot(std::size_t robot, double dt_s) {
  const std::size_t owner = first_robot() + robot;
  const Owner& info = ode_->owners[owner];
  BodyState& body = state_.bodies[static_cast<std::size_t>(info.first_body)];
  if (body.sleep_counter == kAsleep && !IsZero(setpoints_[robot])) {
    for (BodyState& part : BodiesOf(info)) part.sleep_counter = 0;
  }
  moves_[owner] = body.sleep_counter < kAsleep;
  travel_m_[owner] = 0;
  if (moves_[owner]) {
    double speed_m_s = body.v_WB.norm();
    if (info.one_body != nullptr) {
      DrivePlan& plan = plans_[robot];
      plan = PlanDrive(*info.one_body, body, info.rest_z_m, setpoints_[robot], dt_s);
      speed_m_s = std::max(speed_m_s, std::abs(plan.forward_m_s));
    }
    constexpr double kFarthest_m = 0.1;
    travel_m_[owner] = std::min(kFarthest_m, dt_s * speed_m_s);
  }
  broad_phase_->spaces()[robot] = SpaceOf(info, body, travel_m_[owner]);
}

bool Engine::Sort() {
  pairs_ = broad_phase_->FindPairs(*ode_, moves_);
  std::fill(near_.begin(), near_.end(), 0);
  const std::size_t count = dynamic_count(), base = first_robot();
  for (const auto& [a, b] : pairs_) {
    near_[a] = 1;
    if (b < count) near_[b] = 1;
  }
  active_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const bool closed =
        i >= base && ode_->owners[i].one_body != nullptr && !near_[i] && plans_[i - base].closed;
    in_ode_[i] = moves_[i] && !closed;
    if (in_ode_[i]) active_.push_back(static_cast<std::uint32_t>(i));
  }
  return !active_.empty();
}

void Engine::AdvanceClosed(double dt_s) {
  const std::size_t base = first_robot();
  ForAll(plans_.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const Owner& owner = ode_->owners[base + i];
      if (owner.one_body == nullptr || !moves_[base + i] || in_ode_[base + i]) continue;
      BodyState& body = state_.bodies[static_cast<std::size_t>(owner.first_body)];
      const DrivePlan& plan = plans_[i];
      const bool stays = plan.forward_m_s == 0 && plan.turn_rad_s == 0;
      if (!stays || !body.v_WB.isZero(0) || !body.w_WB.isZero(0)) {
        Advance(*owner.one_body, plan, owner.rest_z_m, dt_s, body);
      }
      RobotState& robot = state_.robots[i];
      for (std::size_t side = 0; side < 2; ++side) {
        robot.wheel_angle_rad[side] += plan.wheels_rad_s[side] * dt_s;
        robot.wheel_speed_rad_s[side] += plan.wheels_rad_s[side] * share_;
      }
    }
  });
}

void Engine::CountRest(Nanoseconds dt) {
  const std::size_t base = first_robot();
  for (const std::uint32_t i : active_) rested_[islands_.RootOf(i)] = 1;
  for (const std::uint32_t i : active_) {
    if (!moves_[i]) continue;  // frozen in this very substep
    const bool rests = AtRest(i);
    std::uint64_t counter = first_body(i).sleep_counter;
    counter = rests ? std::min(counter + static_cast<std::uint64_t>(dt), kSleepAfter) : 0;
    for (BodyState& body : BodiesOf(ode_->owners[i])) body.sleep_counter = counter;
    if (counter < kSleepAfter) rested_[islands_.RootOf(i)] = 0;
  }
  for (const std::uint32_t i : active_) {
    if (moves_[i] && rested_[islands_.RootOf(i)]) Sleep(i);
  }
  for (std::size_t i = base; i < dynamic_count(); ++i) {
    if (!moves_[i] || in_ode_[i]) continue;
    BodyState& body = state_.bodies[static_cast<std::size_t>(first_bodies_[i])];
    if (!IsZero(setpoints_[i - base]) || !AtRest(i)) {
      body.sleep_counter = 0;
    } else {
      body.sleep_counter += static_cast<std::uint64_t>(dt);
      if (body.sleep_counter >= kSleepAfter) Sleep(i);
    }
  }
}

bool Engine::AtRest(std::size_t owner) const {
  const Owner& info = ode_->owners[owner];
  if (info.robot >= 0 && !IsZero(setpoints_[static_cast<std::size_t>(info.robot)])) return false;
  for (int i = 0; i < info.body_count; ++i) {
    if (!IsSlow(state_.bodies[static_cast<std::size_t>(info.first_body + i)])) return false;
  }
  return true;
}

void Engine::Sleep(std::size_t owner) {
  const Owner& info = ode_->owners[owner];
  for (BodyState& body : BodiesOf(info)) {
    body.v_WB.setZero();
    body.w_WB.setZero();
    body.sleep_counter = kAsleep;
  }
  Hold(*ode_, info);
}

void Engine::Freeze(std::size_t owner, std::string why) {
  Owner& info = ode_->owners[owner];
  frozen_.push_back({info.name, std::move(why)});
  info.frozen = true;
  moves_[owner] = 0;
  for (BodyState& body : BodiesOf(info)) {
    body.v_WB.setZero();
    body.w_WB.setZero();
    body.sleep_counter = BodyState::kFrozen;
  }
  if (info.robot >= 0) state_.robots[static_cast<std::size_t>(info.robot)].frozen = true;
  if (info.one_body != nullptr) return;
  for (int i = 0; i < info.body_count; ++i) {
    const std::size_t body = static_cast<std::size_t>(info.first_body + i);
    WriteBody(ode_->bodies[body], state_.bodies[body]);
  }
  Hold(*ode_, info);
}

void Engine::Restore(const Frame& frame) {
  state_.bodies = frame.bodies;
  state_.robots = frame.robots;
  state_.solver_seed = frame.solver_seed;
  TellOde();
}

}  // namespace coopdyn
