// SPDX-License-Identifier: MIT
// The sequence of a substep, and the motion that needs no solver. world_solve.cc has the rest.
#include "server/physics/world.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/physics/ode.h"
#include "server/physics/rest.h"

namespace coopdyn {

namespace {

// With fewer robots, waking other threads does not pay.
constexpr std::size_t kParallelFrom = 512, kGrain = 128;

std::uint64_t SolverSeed(std::uint64_t seed) {
  return seed & 0xffffffff;  // ODE's generator has 32 bits
}

}  // namespace

template <typename Work>
void PhysicsWorld::ForAll(std::size_t count, const Work& work) {
  if (pool_ == nullptr || count < kParallelFrom) {
    work(0, count);
  } else {
    pool_->For(count, kGrain, work);
  }
}

std::unique_ptr<PhysicsWorld> PhysicsWorld::Build(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                                  Diagnostics& diagnostics, WorkerPool* pool) {
  const int errors = diagnostics.errors();
  CheckModels(*scene, diagnostics);
  if (diagnostics.errors() > errors) return nullptr;
  std::unique_ptr<PhysicsWorld> world(new PhysicsWorld(std::move(scene), seed, pool));
  CheckStart(*world->scene_, world->things_, diagnostics);
  if (diagnostics.errors() > errors) return nullptr;
  return world;
}

PhysicsWorld::PhysicsWorld(std::shared_ptr<const Scene> scene, std::uint64_t seed, WorkerPool* pool)
    : scene_(std::move(scene)),
      pool_(pool),
      things_(MakeThings(*scene_)),
      bodies_(things_.bodies),
      channels_(scene_->channels.size()),
      controls_(StartControls(*scene_)),
      drive_trains_(StartDriveTrains(*scene_)),
      solver_seed_(SolverSeed(seed)) {
  for (std::size_t i = 0; i < channels_.size(); ++i) channels_[i].position = StartOf(*scene_, i);
  const WorldSettings settings{scene_->scenario->simulation.g_W, scene_->floor.friction};
  for (int i = 0; i < (pool == nullptr ? 1 : pool->threads()); ++i) {
    solvers_.push_back(std::make_unique<Solvers>(things_, settings));
  }
  Fit();
}

void PhysicsWorld::Rebuild(std::shared_ptr<const Scene> scene, const Frame& frame) {
  EnsureOde();
  things_ = MakeThings(*scene, things_);
  scene_ = std::move(scene);
  bodies_ = frame.bodies;
  for (const std::unique_ptr<Solvers>& solvers : solvers_) {
    solvers->lane.Fit();
    solvers->limbs.Fit();
    solvers->pile.Fit();
  }
  Fit();
  Restore(frame);
}

void PhysicsWorld::Fill(Frame& frame) const {
  frame.bodies = bodies_;
  frame.channels = channels_;
  frame.controls = controls_;
  frame.drive_trains = drive_trains_;
  frame.commanded.assign(scene_->actuators.size(), 0);
  frame.solver_seed = solver_seed_;
  measures_.Fill(frame);
}

void PhysicsWorld::Fit() {
  broad_phase_.emplace(things_, bodies_);
  first_bodies_.clear();
  for (std::size_t i = 0; i < dynamic_count(); ++i) {
    first_bodies_.push_back(static_cast<std::size_t>(things_.all[i].first_body));
  }
  plans_.resize(things_.first_static - things_.first_robot);
  for (auto* flags : {&moves_, &near_, &soft_, &in_solver_, &rested_, &calm_}) flags->resize(dynamic_count());
  travel_m_.resize(dynamic_count());
  batch_of_.resize(dynamic_count());
  islands_.Resize(dynamic_count());
  FitBoards();
  measures_.Fit(*scene_, things_);
}

void PhysicsWorld::Step(Nanoseconds step, int substeps, std::span<const Setpoint> setpoints,
                        const NoiseOf& noise) {
  EnsureOde();
  if (!measures_.empty()) measures_.Begin(bodies_);
  TakeSetpoints(setpoints);
  share_ = 1.0 / substeps;
  for (int i = 0; i < substeps; ++i) Substep(step / substeps, substeps - i);
  if (!measures_.empty()) measures_.End({ToSeconds(step), noise.seed, noise.step}, bodies_, channels_);
}

void PhysicsWorld::Substep(Nanoseconds dt, int left) {
  const double dt_s =
      static_cast<double>(dt) * 1e-9;  // not ToSeconds(): recorded runs repeat to the last bit
  if (!board_joints_.empty()) AdvanceBoards(dt_s, left);
  PlanAll(dt_s);
  Sort();
  if (!active_.empty()) {
    Touch(dt_s);
    MakeIslands();
    MakeBatches();
    sweep_.Begin(things_, active_, bodies_, dt_s);
    SolveAll(dt_s);
    sweep_.End(things_, *broad_phase_, solvers_.front()->lane.collider(), bodies_);
  }
  AdvanceClosed(dt_s);
  CountRest(dt);
}

void PhysicsWorld::PlanAll(double dt_s) {
  for (std::size_t i = 0; i < things_.first_robot; ++i) {
    const BodyState& body = FirstBody(i);
    moves_[i] = body.sleep_counter < kAsleep;
    travel_m_[i] = moves_[i] ? dt_s * body.v_WB.norm() : 0;
  }
  ForAll(plans_.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) PlanRobot(i, dt_s);
  });
}

void PhysicsWorld::PlanRobot(std::size_t robot, double dt_s) {
  const std::size_t thing = things_.first_robot + robot;
  const Thing& info = things_.all[thing];
  const BodyState& body = FirstBody(thing);
  if (body.sleep_counter == kAsleep && IsDriven(info)) {
    for (BodyState& part : BodiesOf(static_cast<std::uint32_t>(thing))) part.sleep_counter = 0;
  }
  moves_[thing] = body.sleep_counter < kAsleep;
  double travel_m = 0;
  if (moves_[thing]) {
    double speed_m_s = body.v_WB.norm();
    for (std::size_t k = 0; k < info.mechanism->limb_radii_m.size(); ++k) {
      const BodyState& limb = (&body)[k];
      speed_m_s = std::max(speed_m_s, limb.v_WB.norm() + limb.w_WB.norm() * info.mechanism->limb_radii_m[k]);
    }
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

void PhysicsWorld::Sort() {
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
    in_solver_[i] = moves_[i] && !closed;
    if (in_solver_[i]) active_.push_back(static_cast<std::uint32_t>(i));
  }
}

void PhysicsWorld::AdvanceClosed(double dt_s) {
  const std::size_t base = things_.first_robot;
  ForAll(plans_.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      if (!moves_[base + i] || in_solver_[base + i] || !plans_[i].closed) continue;
      const Thing& thing = things_.all[base + i];
      BodyState& body = bodies_[first_bodies_[base + i]];
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

void PhysicsWorld::CountRest(Nanoseconds dt) {
  for (const std::uint32_t i : active_) {
    const std::uint32_t root = islands_.RootOf(i);
    rested_[root] = 1;
    if (i == root) calm_[root] = IsCalm(root);
  }
  for (const std::uint32_t i : active_) {
    if (!moves_[i]) continue;  // frozen in this very substep
    const auto step = static_cast<std::uint64_t>(dt);
    std::uint64_t counter = FirstBody(i).sleep_counter;
    if (calm_[islands_.RootOf(i)] || AtRest(i)) {
      counter = std::min(counter + step, kSleepAfter);
    } else {
      counter = things_.all[i].mechanism->is_loose() && IsSlow(FirstBody(i), kNearly) && counter > step
                    ? counter - step
                    : 0;
    }
    for (BodyState& body : BodiesOf(i)) body.sleep_counter = counter;
    if (counter < kSleepAfter) rested_[islands_.RootOf(i)] = 0;
  }
  for (const std::uint32_t i : active_) {
    if (moves_[i] && rested_[islands_.RootOf(i)]) Hold(i, kAsleep);
  }
  // A robot that moves by the closed form is its own island.
  for (std::size_t i = things_.first_robot; i < dynamic_count(); ++i) {
    if (!moves_[i] || in_solver_[i]) continue;
    BodyState& body = bodies_[first_bodies_[i]];
    if (!AtRest(static_cast<std::uint32_t>(i))) {
      body.sleep_counter = 0;
      continue;
    }
    body.sleep_counter += static_cast<std::uint64_t>(dt);
    if (body.sleep_counter >= kSleepAfter) Hold(static_cast<std::uint32_t>(i), kAsleep);
  }
}

bool PhysicsWorld::IsCalm(std::uint32_t root) const {
  constexpr int kFew = 8;
  constexpr double kMost_m2_s2 = kRestSpeed_m_s * kRestSpeed_m_s, kEach = kNearly;
  int count = 0;
  double sum_m2_s2 = 0;  // of twice the energies per mass
  for (std::uint32_t i = islands_.FirstOf(root); i != Islands::kNone; i = islands_.NextOf(i)) {
    if (!things_.all[i].mechanism->is_loose()) return false;
    const BodyState& body = FirstBody(i);
    const RigidBody& rigid = things_.all[i].mechanism->bodies.front();
    const double largest_kg_m2 = rigid.inertia_kg_m2.trace() / 2;  // no moment of inertia is larger
    const double twice_m2_s2 =
        body.v_WB.squaredNorm() + largest_kg_m2 / rigid.mass_kg * body.w_WB.squaredNorm();
    if (twice_m2_s2 > kEach * kEach * kMost_m2_s2) return false;
    sum_m2_s2 += twice_m2_s2;
    ++count;
  }
  return count > kFew && sum_m2_s2 <= count * kMost_m2_s2;
}

bool PhysicsWorld::AtRest(std::uint32_t thing) const {
  // Most things move, so the first body usually decides.
  if (!IsSlow(FirstBody(thing))) return false;
  const Thing& info = things_.all[thing];
  if (IsDriven(info) || !RotorsRest(info)) return false;
  for (std::size_t k = 1; k < info.body_count(); ++k) {
    if (!IsSlow(bodies_[first_bodies_[thing] + k])) return false;
  }
  return true;
}

void PhysicsWorld::Hold(std::uint32_t thing, std::uint64_t counter) {
  for (std::size_t i = 0; !board_trains_.empty() && i < things_.all[thing].control_count; ++i) {
    const int train = board_joints_[things_.all[thing].first_control + i].drive_train;
    if (train < 0) continue;
    drive_trains_[static_cast<std::size_t>(train)].rotor_rad_s = 0;
    drive_trains_[static_cast<std::size_t>(train)].current_a = 0;
  }
  for (BodyState& body : BodiesOf(thing)) {
    body.v_WB.setZero();
    body.w_WB.setZero();
    body.sleep_counter = counter;
  }
}

void PhysicsWorld::Restore(const Frame& frame) {
  bodies_ = frame.bodies;
  channels_ = frame.channels;
  controls_ = frame.controls;
  drive_trains_ = frame.drive_trains;
  solver_seed_ = frame.solver_seed;
  measures_.Restore(frame);
  for (std::size_t i = 0; i < dynamic_count(); ++i) {
    Thing& thing = things_.all[i];
    thing.frozen = FirstBody(i).frozen();
    if (thing.robot < 0) broad_phase_->MoveObject(i, FirstBody(i));
  }
}

void PhysicsWorld::Restart(const Frame& start, std::uint64_t seed) {
  Restore(start);
  solver_seed_ = SolverSeed(seed);
  frozen_.clear();
  unsolved_.clear();
}

int DefaultSubsteps(Nanoseconds step) {
  return static_cast<int>((step + kMaxSubstep - 1) / kMaxSubstep);
}

}  // namespace coopdyn
