// SPDX-License-Identifier: MIT
// Simulation::Change(): adds, removes and moves things.
#include <algorithm>
#include <utility>

#include "server/physics/simulation.h"
#include "server/physics/world.h"

namespace coopdyn {

namespace {

const SceneObject* FindObject(const Scene& scene, ObjectId id) {
  const auto found = std::ranges::find(scene.objects, id, &SceneObject::id);
  return found == scene.objects.end() ? nullptr : &*found;
}

int FindRobot(const Scene& scene, RobotId id) {
  const auto found = std::ranges::find(scene.robots, id, &SceneRobot::id);
  return found == scene.robots.end() ? -1 : static_cast<int>(found - scene.robots.begin());
}

std::int32_t WorldIdOf(const Scene& scene, const Thing& thing) {
  if (thing.robot >= 0) return WorldIdOf(scene.robots[static_cast<std::size_t>(thing.robot)]);
  return WorldIdOf(scene.objects[static_cast<std::size_t>(thing.object)]);
}

/// By thing of `things` (made from `scene`): 1 if `change` removes, places or reshapes it. `old`: `scene` is
/// the scene before the change; else the scene after it.
std::vector<std::uint8_t> Chosen(const WorldChange& change, const Scene& scene, const Scene& before,
                                 const Things& things, bool old) {
  std::vector<std::int32_t> ids;
  for (const PutObject& put : change.objects) {
    const SceneObject* was = FindObject(before, put.id);
    if (put.placing == Placing::kKeep && was != nullptr && was->object.IsAlike(put.object)) continue;
    ids.push_back(static_cast<std::int32_t>(put.id.value));
  }
  for (const PutRobot& put : change.robots) {
    if (put.placing == Placing::kKeep) continue;
    ids.push_back(WorldId::kRobots + static_cast<std::int32_t>(put.id.value));
  }
  if (old) {
    for (const ObjectId id : change.gone_objects) ids.push_back(static_cast<std::int32_t>(id.value));
    for (const RobotId id : change.gone_robots)
      ids.push_back(WorldId::kRobots + static_cast<std::int32_t>(id.value));
  }
  std::ranges::sort(ids);
  std::vector<std::uint8_t> chosen(things.all.size());
  for (std::size_t i = 0; i < things.all.size() && !ids.empty(); ++i) {
    chosen[i] = std::ranges::binary_search(ids, WorldIdOf(scene, things.all[i])) ? 1 : 0;
  }
  return chosen;
}

bool SamePlace(const BodyState& a, const BodyState& b) {
  return a.p_WB == b.p_WB && a.q_WB == b.q_WB && a.R_WB == b.R_WB;
}

BodyState Moved(const BodyState& body, const Pose& X_new_old) {
  RigidBody rigid;
  rigid.X_RB = X_new_old * Pose{body.p_WB, body.orientation()};
  Mechanism alone;
  alone.bodies.push_back(rigid);
  return StartBodies(alone, Pose{}).front();
}

/// The bodies of a robot that is placed at `X_WR`, at rest. A robot with limbs keeps its posture.
std::vector<BodyState> PutTo(const Mechanism& mechanism, const Pose& X_WR, const SceneRobot* was,
                             const Frame& before, int index) {
  std::vector<BodyState> start = StartBodies(mechanism, X_WR);
  if (was == nullptr || !mechanism.has_limbs()) return start;
  const auto bodies =
      std::span(before.bodies)
          .subspan(static_cast<std::size_t>(was->first_body), static_cast<std::size_t>(was->body_count));
  if (bodies.size() != start.size()) return start;
  const std::vector<BodyState> begun = StartBodies(mechanism, was->entry.X_WR);
  if (std::ranges::equal(bodies, begun, SamePlace)) return start;
  const Pose X_new_old = X_WR * RobotPose(before, index).Inverse();
  std::vector<BodyState> moved;
  for (const BodyState& body : bodies) moved.push_back(Moved(body, X_new_old));
  return moved;
}

std::uint64_t& CounterOf(Frame& frame, const Thing& thing) {
  return frame.bodies[static_cast<std::size_t>(thing.first_body)].sleep_counter;
}

void SetCounter(Frame& frame, const Thing& thing, std::uint64_t counter) {
  for (std::size_t k = 0; k < thing.body_count(); ++k) {
    frame.bodies[static_cast<std::size_t>(thing.first_body) + k].sleep_counter = counter;
  }
}

/// Sets the place in descriptions that keep theirs but lose the old body: objects that become static, and
/// robots whose model or fidelity changes.
void KeepPlaces(WorldChange& change, const Frame& before) {
  const Scene& scene = *before.scene;
  for (PutObject& put : change.objects) {
    const SceneObject* was = FindObject(scene, put.id);
    if (put.placing != Placing::kKeep || was == nullptr || was->body < 0 || !put.object.is_static()) continue;
    put.object.X_WO = ObjectPose(before, *was);
  }
  for (PutRobot& put : change.robots) {
    const int was = FindRobot(scene, put.id);
    if (put.placing != Placing::kKeep || was < 0) continue;
    const RobotEntry& entry = scene.robots[static_cast<std::size_t>(was)].entry;
    if (entry.model == put.entry.model && entry.fidelity == put.entry.fidelity) continue;
    put.entry.X_WR = RobotPose(before, was);
    put.placing = Placing::kStart;
  }
}

}  // namespace

std::string Simulation::ControllerFaults(const WorldChange& change) const {
  Scenario alone;
  for (const PutRobot& put : change.robots) {
    const int was = FindRobot(*scene_, put.id);
    const bool had = was >= 0 && scene_->robots[static_cast<std::size_t>(was)].entry.controller.name ==
                                     put.entry.controller.name;
    if (!put.entry.controller.empty() && !had) alone.robots.push_back(put.entry);
  }
  if (alone.robots.empty() || helpers_.controllers == nullptr) return {};
  Diagnostics diagnostics;
  helpers_.controllers->Check(alone, diagnostics);
  return diagnostics.has_errors() ? diagnostics.ToString() : "";
}

std::string Simulation::PlaceAll(const WorldChange& change, const Frame& before, Frame& next) const {
  const Scene& scene = *next.scene;
  const Things& things = world_->things();
  const auto put_bodies = [&next](const Thing& thing, const std::vector<BodyState>& bodies) {
    if (bodies.size() != thing.body_count()) return false;
    std::ranges::copy(bodies, next.bodies.begin() + thing.first_body);
    return true;
  };
  const auto copy = [](const auto& from, auto& to, int first, int count) {
    if (from.size() != static_cast<std::size_t>(count)) return false;
    std::ranges::copy(from, to.begin() + first);
    return true;
  };
  for (const Thing& thing : things.all) {
    if (thing.object >= 0) {
      const SceneObject& object = scene.objects[static_cast<std::size_t>(thing.object)];
      if (object.body < 0) continue;
      const auto put = std::ranges::find(change.objects, object.id, &PutObject::id);
      if (put == change.objects.end()) continue;
      const SceneObject* was = FindObject(*before.scene, object.id);
      const bool keeps = put->placing == Placing::kKeep && was != nullptr && was->body >= 0;
      if (keeps) continue;
      const bool exact = put->placing == Placing::kExact && put->body;
      put_bodies(thing, exact ? std::vector{*put->body} : StartBodies(*thing.mechanism, object.object));
      continue;
    }
    const SceneRobot& robot = scene.robots[static_cast<std::size_t>(thing.robot)];
    const auto put = std::ranges::find(change.robots, robot.id, &PutRobot::id);
    if (put == change.robots.end() || put->placing == Placing::kKeep) continue;
    if (put->placing == Placing::kExact) {
      const int measured = static_cast<int>(put->measured.size());
      const bool fits =
          put_bodies(thing, put->bodies) &&
          copy(put->channels, next.channels, robot.first_channel, robot.channel_count) &&
          copy(put->controls, next.controls, robot.first_control, robot.control_count) &&
          copy(put->drive_trains, next.drive_trains, robot.first_drive_train, robot.drive_train_count) &&
          copy(put->measured, next.measured, robot.first_measured, measured);
      if (!fits) return robot.entry.name + " no longer fits its model";
      continue;
    }
    const int index = FindRobot(*before.scene, robot.id);
    const SceneRobot* was = index < 0 ? nullptr : &before.scene->robots[static_cast<std::size_t>(index)];
    const bool same = was != nullptr && was->entry.model == robot.entry.model &&
                      was->entry.fidelity == robot.entry.fidelity;
    put_bodies(thing, PutTo(*thing.mechanism, robot.entry.X_WR, same ? was : nullptr, before, index));
  }
  return {};
}

std::string Simulation::Change(WorldChange& change, WorldChange& inverse) {
  const FramePtr before = frame_;
  AssignIds(*scene_, used_, change);
  KeepPlaces(change, *before);
  std::string refusal;
  const std::shared_ptr<const Scene> scene = ChangedScene(*scene_, change, refusal);
  if (scene == nullptr) return refusal;
  if (!change.robots.empty()) {
    Diagnostics diagnostics;
    CheckModels(*scene, diagnostics);
    if (diagnostics.has_errors()) return diagnostics.ToString();
    if (std::string faults = ControllerFaults(change); !faults.empty()) return faults;
  }
  inverse = InverseOf(change, *before);

  std::vector<std::int32_t> sleepers;  // near things that are removed or moved
  const std::vector<std::uint8_t> going = Chosen(change, *scene_, *scene_, world_->things(), true);
  for (const std::uint32_t near :
       NearChosen(world_->things(), going, PairsOfChosen(world_->things(), before->bodies, going))) {
    sleepers.push_back(WorldIdOf(*scene_, world_->things().all[near]));
  }

  const std::shared_ptr<Frame> draft = InScene(*before, scene);
  draft->measured.clear();  // Restore() then resets them
  world_->Rebuild(scene, *draft);
  Frame begun;
  world_->Fill(begun);
  const std::shared_ptr<Frame> next = InScene(*before, scene, &begun);
  refusal = PlaceAll(change, *before, *next);
  world_->Restore(*next);
  const Things& things = world_->things();
  const std::vector<std::uint8_t> chosen = Chosen(change, *scene, *scene_, things, false);
  std::vector<ThingPair> pairs;
  if (refusal.empty()) {
    pairs = PairsOfChosen(things, next->bodies, chosen);
    refusal = PlacementFault(*scene, things, next->bodies, chosen, pairs);
  }
  if (!refusal.empty()) {
    world_->Rebuild(scene_, *before);
    return refusal;
  }

  std::vector<std::uint32_t> woken = NearChosen(things, chosen, pairs);
  std::ranges::sort(sleepers);
  for (std::uint32_t i = 0; i < things.first_static && !sleepers.empty(); ++i) {
    if (std::ranges::binary_search(sleepers, WorldIdOf(*scene, things.all[i]))) woken.push_back(i);
  }
  for (const std::uint32_t i : woken) {
    const Thing& thing = things.all[i];
    const std::uint64_t counter = CounterOf(*next, thing);
    if (counter == 0 || counter == BodyState::kFrozen) continue;
    inverse.rests.push_back({WorldIdOf(*scene, thing), counter});
    SetCounter(*next, thing, 0);
  }
  for (const RestCounter& rest : change.rests) {
    for (std::uint32_t i = 0; i < things.first_static; ++i) {
      if (WorldIdOf(*scene, things.all[i]) == rest.id) SetCounter(*next, things.all[i], rest.counter);
    }
  }
  for (const PutObject& put : change.objects) {  // a reshaped body in its old place wakes
    const SceneObject* thing = FindObject(*scene, put.id);
    if (put.placing != Placing::kKeep || thing->body < 0) continue;
    const SceneObject* was = FindObject(*scene_, put.id);
    if (was == nullptr || was->object.IsAlike(put.object) || was->body < 0) continue;
    std::uint64_t& counter = next->bodies[static_cast<std::size_t>(thing->body)].sleep_counter;
    const bool told = std::ranges::find(change.rests, static_cast<std::int32_t>(put.id.value),
                                        &RestCounter::id) != change.rests.end();
    if (told || counter == 0 || counter == BodyState::kFrozen) continue;
    inverse.rests.push_back({static_cast<std::int32_t>(put.id.value), counter});
    counter = 0;
  }
  world_->Restore(*next);

  const std::vector<SensorTiming> clocks = scene_->clocks;
  Use(scene);
  messages_ = next->messages;
  samples_.Refit(*next, clocks);
  const std::shared_ptr<Frame> frame = MakeFrame();
  frame->commanded = next->commanded;
  frame->revision = before->revision + 1;
  scores_.Refit(*frame);
  frame_ = frame;
  if (helpers_.controllers != nullptr) helpers_.controllers->Revise(frame_);
  return {};
}

}  // namespace coopdyn
