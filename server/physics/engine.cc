// SPDX-License-Identifier: MIT
// The course of a substep, and what needs no ODE. What does is in engine_solve.cc.
#include "server/physics/engine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/physics/rest.h"

namespace coopdyn {

namespace {

// Fewer robots are not worth waking other threads.
constexpr std::size_t kParallelFrom = 512, kGrain = 128;

}  // namespace

template <typename Work>
void Engine::ForAll(std::size_t count, const Work& work) {
  if (pool_ == nullptr || count < kParallelFrom) {
    work(0, count);
  } else {
    pool_->For(count, kGrain, work);
  }
}

Engine::Engine(const Scene& scene, std::uint64_t solver_seed, WorkerPool* pool)
    : scene_(&scene), pool_(pool), things_(MakeThings(scene)) {
  SetSolverSeed(solver_seed);
  state_.channels.resize(scene.channels.size());
  state_.bodies = things_.bodies;
  const Lane::Settings settings{scene.scenario->simulation.gravity_m_s2, scene.floor.friction};
  for (int i = 0; i < (pool == nullptr ? 1 : pool->threads()); ++i) {
    lanes_.push_back(std::make_unique<Lane>(things_, settings));
  }
  Fit();
}

void Engine::Rebuild(const Scene& scene, const Frame& frame) {
  scene_ = &scene;
  things_ = MakeThings(scene, things_);
  state_.bodies = frame.bodies;
  for (const std::unique_ptr<Lane>& lane : lanes_) lane->Fit();
  Fit();
  Restore(frame);
}

void Engine::Fit() {
  broad_phase_.emplace(things_, state_.bodies);
  first_bodies_.clear();
  for (std::size_t i = 0; i < dynamic_count(); ++i) {
    first_bodies_.push_back(static_cast<std::size_t>(things_.all[i].first_body));
  }
  plans_.resize(things_.first_static - things_.first_robot);
  for (auto* flags : {&moves_, &near_, &in_ode_, &rested_}) flags->resize(dynamic_count());
  travel_m_.resize(dynamic_count());
  batch_of_.resize(dynamic_count());
  islands_.Resize(dynamic_count());
}

void Engine::Step(Nanoseconds step, int substeps, std::span<const Setpoint> setpoints) {
  for (std::size_t i = 0; i < state_.channels.size(); ++i) {
    ChannelState& channel = state_.channels[i];
    channel.setpoint = i < setpoints.size() ? setpoints[i] : Setpoint{};
    channel.velocity = 0;
  }
  share_ = 1.0 / substeps;
  for (int i = 0; i < substeps; ++i) Substep(step / substeps);
}

void Engine::Substep(Nanoseconds dt) {
  const double dt_s =
      static_cast<double>(dt) * 1e-9;  // not ToSeconds(): recorded runs repeat to the last bit
  PlanAll(dt_s);
  Sort();
  if (!active_.empty()) {
    Touch(dt_s);
    MakeIslands();
    MakeBatches();
    SolveAll(dt_s);
  }
  AdvanceClosed(dt_s);
  CountRest(dt);
}

void Engine::PlanAll(double dt_s) {
  for (std::size_t i = 0; i < things_.first_robot; ++i) {
    const BodyState& body = FirstBody(i);
    moves_[i] = body.sleep_counter < kAsleep;
    travel_m_[i] = moves_[i] ? dt_s * body.v_WB.norm() : 0;
  }
  ForAll(plans_.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) PlanRobot(i, dt_s);
  });
}

void Engine::PlanRobot(std::size_t robot, double dt_s) {
  const std::size_t thing = things_.first_robot + robot;
  const Thing& info = things_.all[thing];
  const BodyState& body = FirstBody(thing);
  if (body.sleep_counter == kAsleep && IsDriven(ChannelsOf(info))) {
    for (BodyState& part : BodiesOf(static_cast<std::uint32_t>(thing))) part.sleep_counter = 0;
  }
  moves_[thing] = body.sleep_counter < kAsleep;
  double travel_m = 0;
  if (moves_[thing]) {
    double speed_m_s = body.v_WB.norm();
    DrivePlan& plan = plans_[robot];
    if (info.mechanism->drive) {
      const OneBodyDrive& drive = *info.mechanism->drive;
      plan = PlanDrive(drive, body, info.rest_z_m, drive.SpeedsOf(ChannelsOf(info)), dt_s);
      speed_m_s = std::max(speed_m_s, std::abs(plan.forward_m_s));
    } else {
      plan.closed = false;
    }
    constexpr double kFarthest_m = 0.1;
    travel_m = std::min(kFarthest_m, dt_s * speed_m_s);
  }
  travel_m_[thing] = travel_m;
  broad_phase_->spaces()[robot] = SpaceOf(info, body, travel_m);
}

void Engine::Sort() {
  pairs_ = broad_phase_->FindPairs(moves_);
  std::fill(near_.begin(), near_.end(), std::uint8_t{0});
  const std::size_t count = dynamic_count(), base = things_.first_robot;
  for (const auto& [a, b] : pairs_) {
    near_[a] = 1;
    if (b < count) near_[b] = 1;
  }
  active_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const bool closed = i >= base && !near_[i] && plans_[i - base].closed;
    in_ode_[i] = moves_[i] && !closed;
    if (in_ode_[i]) active_.push_back(static_cast<std::uint32_t>(i));
  }
}

void Engine::AdvanceClosed(double dt_s) {
  const std::size_t base = things_.first_robot;
  ForAll(plans_.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      if (!moves_[base + i] || in_ode_[base + i] || !plans_[i].closed) continue;
      const Thing& thing = things_.all[base + i];
      BodyState& body = state_.bodies[first_bodies_[base + i]];
      const DrivePlan& plan = plans_[i];
      const bool stays = plan.forward_m_s == 0 && plan.turn_rad_s == 0;
      if (!stays || !body.v_WB.isZero(0) || !body.w_WB.isZero(0)) {
        Advance(*thing.mechanism->drive, plan, thing.rest_z_m, dt_s, body);
      }
      const std::span<ChannelState> wheels = thing.mechanism->drive->ChannelsOf(ChannelsOf(thing));
      for (std::size_t wheel = 0; wheel < wheels.size(); ++wheel) {
        Turn(wheels[wheel], plan.wheels_rad_s[wheel], dt_s);
      }
    }
  });
}

void Engine::CountRest(Nanoseconds dt) {
  for (const std::uint32_t i : active_) rested_[islands_.RootOf(i)] = 1;
  for (const std::uint32_t i : active_) {
    if (!moves_[i]) continue;  // frozen in this very substep
    std::uint64_t counter = FirstBody(i).sleep_counter;
    counter = AtRest(i) ? std::min(counter + static_cast<std::uint64_t>(dt), kSleepAfter) : 0;
    for (BodyState& body : BodiesOf(i)) body.sleep_counter = counter;
    if (counter < kSleepAfter) rested_[islands_.RootOf(i)] = 0;
  }
  for (const std::uint32_t i : active_) {
    if (moves_[i] && rested_[islands_.RootOf(i)]) Hold(i, kAsleep);
  }
  // What is not in ODE is an island of its own.
  for (std::size_t i = things_.first_robot; i < dynamic_count(); ++i) {
    if (!moves_[i] || in_ode_[i]) continue;
    BodyState& body = state_.bodies[first_bodies_[i]];
    if (!AtRest(static_cast<std::uint32_t>(i))) {
      body.sleep_counter = 0;
      continue;
    }
    body.sleep_counter += static_cast<std::uint64_t>(dt);
    if (body.sleep_counter >= kSleepAfter) Hold(static_cast<std::uint32_t>(i), kAsleep);
  }
}

bool Engine::AtRest(std::uint32_t thing) const {
  const Thing& info = things_.all[thing];
  if (IsDriven(ChannelsOf(info))) return false;
  for (std::size_t k = 0; k < info.body_count(); ++k) {
    if (!IsSlow(state_.bodies[first_bodies_[thing] + k])) return false;
  }
  return true;
}

void Engine::Hold(std::uint32_t thing, std::uint64_t counter) {
  for (BodyState& body : BodiesOf(thing)) {
    body.v_WB.setZero();
    body.w_WB.setZero();
    body.sleep_counter = counter;
  }
}

void Engine::SetSolverSeed(std::uint64_t seed) {
  state_.solver_seed = seed & 0xffffffff;  // ODE's generator has 32 bits
}

void Engine::Restore(const Frame& frame) {
  state_.bodies = frame.bodies;
  state_.channels = frame.channels;
  state_.solver_seed = frame.solver_seed;
  for (std::size_t i = 0; i < dynamic_count(); ++i) {
    Thing& thing = things_.all[i];
    thing.frozen = FirstBody(i).frozen();
    if (thing.robot < 0) broad_phase_->MoveObject(i, FirstBody(i));
  }
}

}  // namespace coopdyn
