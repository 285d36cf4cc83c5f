// SPDX-License-Identifier: MIT
// The part of a substep that needs a solver: ODE or our own.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <optional>
#include <type_traits>
#include <utility>

#include "server/base/portable_math.h"
#include "server/physics/ode.h"
#include "server/physics/rest.h"
#include "server/physics/world.h"

namespace coopdyn {

namespace {

// Up to this gap a robot has floor contacts, so it is held at its height rather than dropped and caught.
constexpr double kFloorGap_m = 2e-3;
// Things per batch: enough that a call of ODE pays, few enough to stay in the cache.
constexpr std::size_t kBatchThings = 8;

/// Returns a planar robot to its plane, upright.
void Flatten(BodyState& body, double rest_z_m) {
  const double norm = portable::Hypot(body.q_WB[0], body.q_WB[3]);
  const double w = body.q_WB[0] / norm, z = body.q_WB[3] / norm;
  const double c = w * w - z * z, s = 2 * w * z;
  body.q_WB = {w, 0, 0, z};
  body.R_WB = {c, -s, 0, s, c, 0, 0, 0, 1};
  body.p_WB.z() = rest_z_m;
  body.v_WB.z() = 0;
  body.w_WB = {0, 0, body.w_WB.z()};
}

double FloorGap(const Thing& thing, const BodyState& body, double dt_s) {
  return thing.mechanism->is_loose() ? kAhead_m : kFloorGap_m + dt_s * std::abs(body.v_WB.z());
}

}  // namespace

void PhysicsWorld::Touch(double dt_s) {
  while (!FindPairContacts(dt_s)) Sort();
}

bool PhysicsWorld::FindPairContacts(double dt_s) {
  const std::size_t count = dynamic_count();
  Collider& collider = solvers_.front()->lane.collider();
  found_.clear();
  found_ends_.clear();
  bool settled = true;
  for (const auto& [a, b] : pairs_) {
    const std::size_t before = found_.size();
    const double margin_m = travel_m_[a] + (b < count ? travel_m_[b] : 0);
    FindContacts(collider, ActorOf(a), ActorOf(b), margin_m, found_);
    found_ends_.push_back(found_.size());
    if (found_.size() == before) continue;
    for (const std::uint32_t sleeper : {a, b}) {
      if (sleeper >= count || FirstBody(sleeper).sleep_counter != kAsleep) continue;
      Wake(sleeper, dt_s);
      settled = false;
    }
  }
  return settled;
}

std::span<const FoundContact> PhysicsWorld::ContactsOf(std::size_t pair) const {
  const std::size_t first = pair == 0 ? 0 : found_ends_[pair - 1];
  return std::span(found_).subspan(first, found_ends_[pair] - first);
}

void PhysicsWorld::Wake(std::uint32_t thing, double dt_s) {
  for (BodyState& body : BodiesOf(thing)) body.sleep_counter = 0;
  moves_[thing] = 1;
  const int robot = things_.all[thing].robot;
  if (robot >= 0) PlanRobot(static_cast<std::size_t>(robot), dt_s);
}

void PhysicsWorld::MakeIslands() {
  const std::size_t count = dynamic_count();
  std::vector<FoundContact> floor;
  for (const std::uint32_t i : active_) {
    const Mechanism& mechanism = *things_.all[i].mechanism;
    int rows = 0;
    if (!mechanism.is_loose()) {
      rows = mechanism.joint_rows + mechanism.floor_rows + kRobotSurcharge;
    } else {
      floor.clear();
      FindFloorContacts(solvers_.front()->lane.collider(), ActorOf(i), kAhead_m, floor);
      for (const FoundContact& contact : floor) rows += RowsOf(contact);
    }
    islands_.Begin(i, rows);
    soft_[i] = mechanism.is_soft();
  }
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const std::span<const FoundContact> contacts = ContactsOf(k);
    if (contacts.empty()) continue;
    const auto [a, b] = pairs_[k];
    const bool in_a = in_solver_[a], in_b = b < count && in_solver_[b];
    if (!in_a && !in_b) continue;
    if (things_.all[a].mechanism->is_soft() || things_.all[b].mechanism->is_soft()) soft_[in_a ? a : b] = 1;
    int rows = 0;
    for (const FoundContact& contact : contacts) rows += RowsOf(contact);
    islands_.AddRows(in_a ? a : b, rows);
    if (in_a && in_b) islands_.Join(a, b);
  }
  islands_.List(active_);
}

PhysicsWorld::Batch& PhysicsWorld::NextBatch(Method method) {
  if (batch_count_ == batches_.size()) batches_.emplace_back();
  Batch& batch = batches_[batch_count_++];
  batch.method = method;
  batch.members.clear();
  batch.pairs.clear();
  batch.frozen.clear();
  batch.measured.clear();
  batch.unsolved = batch.is_solved = false;
  return batch;
}

void PhysicsWorld::MakeBatches() {
  batch_count_ = 0;
  NextBatch(Method::kIterative);
  std::size_t open = 0;  // 0: none
  for (const std::uint32_t root : islands_.roots()) {
    std::size_t at = 0;
    const bool is_soft = IsSoft(root);
    if (HasLimbs(root) || Flies(root) || (is_soft && !IsSoftPile(root))) {
      at = batch_count_;
      NextBatch(Method::kLimbs);
    } else if (is_soft || IsPile(root)) {
      at = batch_count_;
      NextBatch(Method::kPile);
    } else if (IsPlane(root)) {
      at = batch_count_;
      NextBatch(Method::kPlane);
    } else if (islands_.RowsOf(root) <= kMaxDirectRows) {
      if (open == 0 || batches_[open].members.size() >= kBatchThings) {
        open = batch_count_;
        NextBatch(Method::kDirect);
      }
      at = open;
    }
    batch_of_[root] = static_cast<std::uint32_t>(at);
    for (std::uint32_t i = islands_.FirstOf(root); i != Islands::kNone; i = islands_.NextOf(i)) {
      batches_[at].members.push_back(i);
    }
  }
  const std::size_t count = dynamic_count();
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const auto [a, b] = pairs_[k];
    const bool in_a = in_solver_[a], in_b = b < count && in_solver_[b];
    if ((!in_a && !in_b) || ContactsOf(k).empty()) continue;
    batches_[batch_of_[RootOfPair(k)]].pairs.push_back(static_cast<std::uint32_t>(k));
  }
}

std::uint32_t PhysicsWorld::RootOfPair(std::size_t pair) {
  const auto [a, b] = pairs_[pair];
  return islands_.RootOf(in_solver_[a] ? a : b);
}

bool PhysicsWorld::IsPlane(std::uint32_t root) const {
  for (std::uint32_t i = islands_.FirstOf(root); i != Islands::kNone; i = islands_.NextOf(i)) {
    const Thing& thing = things_.all[i];
    const std::optional<OneBodyDrive>& drive = thing.mechanism->drive;
    if (!thing.mechanism->planar() || !drive || !drive->stands || measures_.Wants(i) ||
        !StandsUpright(FirstBody(i), thing.rest_z_m))
      return false;
  }
  return true;
}

bool PhysicsWorld::FitsPlane(std::size_t pair) const {
  const auto fits = [&](std::uint32_t thing) {
    const Thing& info = things_.all[thing];
    return info.robot >= 0 ? info.mechanism->one_body() : info.body_count() == 0;
  };
  const auto [a, b] = pairs_[pair];
  return fits(a) && fits(b) && PlaneSolver::Takes(ContactsOf(pair));
}

bool PhysicsWorld::HasLimbs(std::uint32_t root) const {
  for (std::uint32_t i = islands_.FirstOf(root); i != Islands::kNone; i = islands_.NextOf(i)) {
    if (things_.all[i].mechanism->has_limbs()) return true;
  }
  return false;
}

bool PhysicsWorld::IsSoft(std::uint32_t root) const {
  for (std::uint32_t i = islands_.FirstOf(root); i != Islands::kNone; i = islands_.NextOf(i)) {
    if (soft_[i]) return true;
  }
  return false;
}

bool PhysicsWorld::IsSoftPile(std::uint32_t root) const {
  constexpr int kFew = 3;  // so few cost little as limbs
  int count = 0;
  for (std::uint32_t i = islands_.FirstOf(root); i != Islands::kNone; i = islands_.NextOf(i)) {
    if (!things_.all[i].mechanism->is_loose()) return false;
    ++count;
  }
  return count > kFew;
}

bool PhysicsWorld::IsPile(std::uint32_t root) {
  // When many objects tumble, their contacts change too often for Newton's method. The work grows with the
  // square of the number of objects, or faster if each touches many.
  constexpr int kFew = 64, kMost = 256, kMostRows = 6000;
  constexpr double kCalm_m_s = 0.5;
  int count = 0;
  bool is_calm = true;
  for (std::uint32_t i = islands_.FirstOf(root); i != Islands::kNone; i = islands_.NextOf(i)) {
    if (!things_.all[i].mechanism->is_loose()) return false;
    ++count;
    is_calm &= FirstBody(i).v_WB.squaredNorm() < kCalm_m_s * kCalm_m_s;
  }
  return count <= (is_calm ? kMost : kFew) && islands_.RowsOf(root) <= kMostRows;
}

template <typename Work>
void PhysicsWorld::ForBatches(const Work& work) {
  const std::size_t small = batch_count_ - 1;
  const auto some = [&](std::size_t first, std::size_t end, Solvers& solvers) {
    for (std::size_t i = first; i < end; ++i) work(1 + i, solvers);
  };
  constexpr std::size_t kParallelFrom = 4;  // batches: some 100 µs
  if (pool_ == nullptr || small < kParallelFrom) {
    some(0, small, *solvers_.front());
    return;
  }
  // Each part uses any free set of solvers: all give the same bits.
  const std::size_t count = solvers_.size(), each = (small + 4 * count - 1) / (4 * count);
  std::vector<std::atomic_flag> taken(count);
  pool_->For(small, each, [&](std::size_t first, std::size_t end) {
    std::size_t mine = 0;
    while (taken[mine].test_and_set(std::memory_order_acquire)) mine = (mine + 1) % count;
    some(first, end, *solvers_[mine]);
    taken[mine].clear(std::memory_order_release);
  });
}

void PhysicsWorld::SolvePlane(Batch& batch, PlaneSolver& solver, double dt_s) {
  if (!std::ranges::all_of(batch.pairs, [&](std::uint32_t pair) { return FitsPlane(pair); })) return;
  solver.Begin();
  for (const std::uint32_t thing : batch.members) {
    solver.Add(ActorOf(thing), ChannelsOf(things_.all[thing]), dt_s);
  }
  const auto number = [&](std::uint32_t thing) {
    const auto at = std::ranges::lower_bound(batch.members, thing);
    if (at == batch.members.end() || *at != thing) return PlaneSolver::kStatic;
    return static_cast<std::uint32_t>(at - batch.members.begin());
  };
  for (const std::uint32_t pair : batch.pairs) {
    const auto [a, b] = pairs_[pair];
    solver.Join(ContactsOf(pair), number(a), number(b), dt_s);
  }
  const PlaneSolver::Outcome outcome = solver.Step();
  if (outcome == PlaneSolver::Outcome::kInsane) return;
  batch.is_solved = true;
  batch.unsolved = outcome == PlaneSolver::Outcome::kNear;
  for (std::uint32_t i = 0; i < batch.members.size(); ++i) {
    const std::uint32_t thing = batch.members[i];
    solver.Move(i, dt_s, BodiesOf(thing).front());
    TurnWheels(thing, dt_s);
  }
}

void PhysicsWorld::SolvePlanes(double dt_s) {
  ForBatches([&](std::size_t i, Solvers& solvers) {
    if (batches_[i].method == Method::kPlane) SolvePlane(batches_[i], solvers.plane, dt_s);
  });
  Batch& large = batches_.front();
  for (std::size_t i = 1; i < batch_count_; ++i) {
    Batch& batch = batches_[i];
    if (batch.method != Method::kPlane || batch.is_solved) continue;
    batch.method = Method::kDirect;
    if (islands_.RowsOf(batch.members.front()) <= kMaxDirectRows) continue;
    large.members.insert(large.members.end(), batch.members.begin(), batch.members.end());
    large.pairs.insert(large.pairs.end(), batch.pairs.begin(), batch.pairs.end());
    batch.is_solved = true;
  }
}

void PhysicsWorld::SolveAll(double dt_s) {
  SolvePlanes(dt_s);
  Batch& large = batches_.front();
  if (!large.members.empty()) {
    // The iterative solver uses ODE's single global random generator, so it runs alone.
    dRandSetSeed(static_cast<unsigned long>(solver_seed_));
    SolveBatch(large, *solvers_.front(), dt_s);
    solver_seed_ = dRandGetSeed();
  }
  ForBatches([&](std::size_t i, Solvers& solvers) {
    if (!batches_[i].is_solved) SolveBatch(batches_[i], solvers, dt_s);
  });
  for (std::size_t k = 0; k < batch_count_; ++k) {
    if (!batches_[k].measured.empty()) measures_.Add(batches_[k].measured, share_);
    for (auto& [thing, why] : batches_[k].frozen) {
      frozen_.push_back({NameOf(*scene_, things_.all[thing]), std::move(why)});
    }
    if (batches_[k].unsolved) unsolved_.push_back(NameOf(*scene_, things_.all[batches_[k].members.front()]));
  }
  for (const std::uint32_t i : active_) {
    if (i < things_.first_robot) broad_phase_->MoveObject(i, FirstBody(i));
  }
}

void PhysicsWorld::SolveBatch(Batch& batch, Solvers& solvers, double dt_s) {
  EnsureOde();
  if (batch.is_for_ode()) solvers.lane.Reserve(batch.members);
  while (true) {
    std::optional<std::string> why = TryBatch(batch, solvers, dt_s);
    if (!why) break;
    if (!FreezeFastest(std::move(*why), batch)) return;
  }
  if (batch.is_solved) return;
  if (batch.method == Method::kLimbs) {
    ReadBatch(batch, solvers.limbs, dt_s);
    solvers.limbs.Unload();
  } else if (batch.method == Method::kPile) {
    ReadBatch(batch, solvers.pile, dt_s);
    solvers.pile.Unload();
  } else {
    ReadBatch(batch, solvers.lane, dt_s);
    solvers.lane.Unload();
  }
}

std::optional<std::string> PhysicsWorld::TryBatch(Batch& batch, Solvers& solvers, double dt_s) {
  if (batch.method == Method::kLimbs) {
    LoadBatch(batch, solvers.lane, solvers.limbs, dt_s);
    const LimbSolver::Outcome outcome = solvers.limbs.Step(dt_s);
    batch.unsolved = outcome == LimbSolver::Outcome::kNear;
    if (outcome != LimbSolver::Outcome::kInsane) return std::nullopt;
    solvers.limbs.Unload();
    return "its joints and contacts have no solution";
  }
  if (batch.method == Method::kPile) {
    LoadBatch(batch, solvers.lane, solvers.pile, dt_s);
    batch.unsolved = !solvers.pile.Step(dt_s);
    return std::nullopt;
  }
  try {
    LoadBatch(batch, solvers.lane, solvers.lane, dt_s);
    if (solvers.lane.Step(batch.method == Method::kDirect ? Lane::Solver::kDirect : Lane::Solver::kIterative,
                          dt_s))
      return std::nullopt;
    solvers.lane.Unload();
    const std::uint32_t root = islands_.RootOf(batch.members.front());
    if (islands_.RootOf(batch.members.back()) != root) {
      SolveIslands(batch, solvers, dt_s);
      return std::nullopt;
    }
    // ODE's direct solver gives up where many contacts share a load. Ours does not.
    batch.method = Method::kLimbs;
    return TryBatch(batch, solvers, dt_s);
  } catch (const OdeError& error) {
    solvers.lane.Reset();
    return error.what();
  }
}

void PhysicsWorld::SolveIslands(Batch& batch, Solvers& solvers, double dt_s) {
  for (auto first = batch.members.begin(); first != batch.members.end();) {
    const std::uint32_t root = islands_.RootOf(*first);
    const auto end =
        std::find_if(first, batch.members.end(), [&](std::uint32_t i) { return islands_.RootOf(i) != root; });
    Batch island;
    island.members.assign(first, end);
    std::ranges::copy_if(batch.pairs, std::back_inserter(island.pairs),
                         [&](std::uint32_t pair) { return RootOfPair(pair) == root; });
    SolveBatch(island, solvers, dt_s);
    batch.measured.insert(batch.measured.end(), island.measured.begin(), island.measured.end());
    std::ranges::move(island.frozen, std::back_inserter(batch.frozen));
    batch.unsolved |= island.unsolved;
    first = end;
  }
  batch.is_solved = true;
}

bool PhysicsWorld::FreezeFastest(std::string why, Batch& batch) {
  std::uint32_t fastest = Islands::kNone;
  double most = -1;
  for (const std::uint32_t thing : batch.members) {
    if (!moves_[thing]) continue;
    for (const BodyState& body : BodiesOf(thing)) {
      if (LimitRatio(body) <= most) continue;
      most = LimitRatio(body);
      fastest = thing;
    }
  }
  if (fastest == Islands::kNone) return false;
  Freeze(fastest, std::move(why), batch);
  return true;
}

template <typename Solver>
void PhysicsWorld::LoadBatch(const Batch& batch, Lane& lane, Solver& solver, double dt_s) {
  for (const std::uint32_t thing : batch.members) {
    if (!moves_[thing]) continue;
    const Thing& info = things_.all[thing];
    if constexpr (std::is_same_v<Solver, Lane>) {
      solver.Load(thing, ActorOf(thing), ChannelsOf(info));
    } else if constexpr (std::is_same_v<Solver, PileSolver>) {
      solver.Load(thing, ActorOf(thing), dt_s);
    } else {
      solver.Load(thing, ActorOf(thing), ChannelsOf(info), JointRowsOf(info), dt_s);
    }
  }
  std::vector<FoundContact>& floor = lane.scratch();
  for (const std::uint32_t thing : batch.members) {
    if (!moves_[thing]) continue;
    const Actor actor = ActorOf(thing);
    floor.clear();
    FindFloorContacts(lane.collider(), actor, FloorGap(actor.thing, actor.bodies[0], dt_s), floor);
    solver.Join(floor, actor, thing, nullptr, 0, dt_s, measures_.Wants(thing));
  }
  for (const std::uint32_t pair : batch.pairs) {
    const auto [a, b] = pairs_[pair];
    const Actor actor_a = ActorOf(a), actor_b = ActorOf(b);
    solver.Join(ContactsOf(pair), actor_a, a, &actor_b, b, dt_s, measures_.Wants(a) || measures_.Wants(b));
  }
}

template <typename Solver>
void PhysicsWorld::ReadBatch(Batch& batch, const Solver& solver, double dt_s) {
  if (!measures_.empty()) batch.measured.assign(solver.measured().begin(), solver.measured().end());
  for (const std::uint32_t thing : batch.members) {
    if (!moves_[thing]) continue;
    const Thing& info = things_.all[thing];
    const std::span<BodyState> bodies = BodiesOf(thing);
    std::optional<std::string> why;
    for (std::size_t k = 0; k < bodies.size() && !why; ++k) why = FindFault(solver.Read(thing, k));
    if (why) {
      Freeze(thing, *why, batch);
      continue;
    }
    if constexpr (std::is_same_v<Solver, LimbSolver>) {
      if (solver.flies()) measures_.AddFlight(thing, share_);
    }
    const std::vector<double> rates_before = RatesOf(thing);
    for (std::size_t k = info.mechanism->fixed_base ? 1 : 0; k < bodies.size(); ++k) {
      const std::uint64_t counter = bodies[k].sleep_counter;
      bodies[k] = solver.Read(thing, k);
      bodies[k].sleep_counter = counter;
    }
    if (info.mechanism->one_body() && info.mechanism->planar()) Flatten(bodies.front(), info.rest_z_m);
    if constexpr (!std::is_same_v<Solver, PileSolver>) {
      if (info.channel_count > 0) ReadChannels(thing, solver, dt_s);
    }
    // Effort × mean rate: exact if only the motor moves the body.
    const std::vector<double> rates = RatesOf(thing);
    for (std::size_t i = 0; i < rates.size(); ++i) {
      const int channel = info.mechanism->joints[i].channel;
      if (channel < 0) continue;
      const auto index = static_cast<std::size_t>(channel);
      const double mean_rate = (rates_before[i] + rates[i]) / 2;
      measures_.AddWork(info.first_channel + index, ChannelsOf(info)[index].effort * mean_rate * dt_s);
    }
  }
}

template <typename Solver>
void PhysicsWorld::ReadChannels(std::uint32_t thing, const Solver& solver, double dt_s) {
  const Thing& info = things_.all[thing];
  const std::span<ChannelState> channels = ChannelsOf(info);
  if (!info.mechanism->one_body()) {
    for (std::size_t i = 0; i < info.mechanism->joints.size(); ++i) {
      const Joint& joint = info.mechanism->joints[i];
      if (joint.channel < 0) continue;
      ChannelState& channel = channels[static_cast<std::size_t>(joint.channel)];
      [[maybe_unused]] const double last = channel.position;
      Turn(channel, solver.JointRate(thing, i), dt_s);
      if constexpr (std::is_same_v<Solver, LimbSolver>) {
        if (joint.board != nullptr || joint.model->muscle)
          channel.position = solver.JointPosition(thing, i, last);
      }
      channel.effort = solver.JointEffort(thing, i);
      if (joint.control < 0 || board_trains_.empty()) continue;
      FinishTrain(info.first_control + static_cast<std::size_t>(joint.control), channel.effort, dt_s);
    }
  } else if (info.mechanism->drive) {
    TurnWheels(thing, dt_s);
  }
}

void PhysicsWorld::TurnWheels(std::uint32_t thing, double dt_s) {
  const Thing& info = things_.all[thing];
  const OneBodyDrive& drive = *info.mechanism->drive;
  const std::span<ChannelState> channels = ChannelsOf(info);
  const WheelSpeeds rates_rad_s = WheelRates(drive, FirstBody(thing), drive.SpeedsOf(channels));
  const std::span<ChannelState> wheels = drive.ChannelsOf(channels);
  for (std::size_t wheel = 0; wheel < wheels.size(); ++wheel) Turn(wheels[wheel], rates_rad_s[wheel], dt_s);
}

void PhysicsWorld::Freeze(std::uint32_t thing, std::string why, Batch& batch) {
  Thing& info = things_.all[thing];
  info.frozen = true;
  moves_[thing] = 0;
  Hold(thing, BodyState::kFrozen);
  batch.frozen.emplace_back(thing, std::move(why));
}

}  // namespace coopdyn
