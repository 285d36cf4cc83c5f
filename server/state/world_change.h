// SPDX-License-Identifier: MIT
// An edit of what stands in the world, in the one form that the stepping thread, the journal, undo and a
// repetition share: which things go, which are put there or take the place of one with their id. It needs no
// files. Plain values and pure functions; any thread.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/state/frame.h"

namespace coopdyn {

/// Where a thing is that an edit puts into the world.
enum class Placing : std::uint8_t {
  kStart,  // at rest where its description says
  kKeep,   // where it is, as it moves: it has another description only
  kExact,  // as the states say that come with it
};

struct PutObject {
  ObjectId id;  // none: a new one
  WorldObject object;
  Placing placing = Placing::kStart;
  std::optional<BodyState> body = {};  // kExact, unless it is static
};

struct PutRobot {
  RobotId id;  // none: a new one
  RobotEntry entry;
  Placing placing = Placing::kStart;
  // kExact:
  std::vector<BodyState> bodies = {};
  std::vector<ChannelState> channels = {};
  std::vector<JointControl> controls = {};
  std::vector<DriveTrainState> drive_trains = {};
  std::vector<double> measured = {};
};

/// A thing in the space of ids of /world: 1… things, kRobots + 1… robots, and so on.
struct WorldId {
  static constexpr std::int32_t kRobots = 1'000'000, kTargets = 2'000'000, kLights = 3'000'000;
  static constexpr std::int32_t kMost = 999'999;  // of one kind
};

inline std::int32_t WorldIdOf(const SceneObject& thing) {
  return static_cast<std::int32_t>(thing.id.value);
}
inline std::int32_t WorldIdOf(const SceneRobot& robot) {
  return WorldId::kRobots + static_cast<std::int32_t>(robot.id.value);
}
inline std::int32_t WorldIdOf(const Target& target) {
  return WorldId::kTargets + static_cast<std::int32_t>(target.id.value);
}
/// Of the light at this place among the scene's.
inline std::int32_t LightId(std::size_t place) {
  return WorldId::kLights + static_cast<std::int32_t>(place) + 1;
}

/// How long a dynamic thing has been at rest.
struct RestCounter {
  std::int32_t id = 0;  // WorldId
  std::uint64_t counter = 0;
};

/// Begins the label of what the supervisor changes; no other label begins so.
inline constexpr const char* kSupervisorLabel = "supervisor ";

struct WorldChange {
  std::string label;  // for people: "insert BOX_1"
  std::vector<ObjectId> gone_objects;
  std::vector<RobotId> gone_robots;
  std::vector<TargetId> gone_targets;
  std::vector<PutObject> objects;
  std::vector<PutRobot> robots;
  std::vector<Target> targets;                         // id: none, a new one
  std::optional<std::vector<PointLight>> lights = {};  // all of them
  std::vector<RestCounter> rests = {};                 // of others: an undo at once lets them sleep again

  bool empty() const {
    return gone_objects.empty() && gone_robots.empty() && gone_targets.empty() && objects.empty() &&
           robots.empty() && targets.empty() && !lights;
  }
};

/// What a target is called in /world and in legends: red_target_1.
std::string TargetName(const Target& target);

/// Gives new things their ids, the next after those of `scene` and of `used`, which it brings up to date.
struct UsedIds {
  std::uint32_t object = 0, robot = 0, target = 0;
};
void AssignIds(const Scene& scene, UsedIds& used, WorldChange& change);

/// The scene after `change`, whose things have ids. Null, and `refusal` says why, if it cannot be: a name
/// that is taken, an id that is not there, too many.
std::shared_ptr<const Scene> ChangedScene(const Scene& scene, const WorldChange& change,
                                          std::string& refusal);

/// `from` as a moment of `scene`: what both scenes have keeps its state; what is new has that of `other`, a
/// frame of `scene`, or if null stands at the origin at rest. Contacts with what is gone are left out.
std::shared_ptr<Frame> InScene(const Frame& from, const std::shared_ptr<const Scene>& scene,
                               const Frame* other = nullptr);

/// What undoes `change`, if applied to the scene that it makes of `before`.
WorldChange InverseOf(const WorldChange& change, const Frame& before);

/// By robot id: where the robots of `scene` are in `before`; -1: not there.
std::vector<int> PlacesIn(const Scene& before, const Scene& scene);

/// What belongs to the channels of `before`, laid out for those of `scene`; new ones get `fresh`.
template <typename Value>
std::vector<Value> InChannelsOf(const Scene& scene, const Scene& before, const std::vector<Value>& values,
                                const Value& fresh) {
  std::vector<Value> now(scene.channels.size(), fresh);
  const std::vector<int> places = PlacesIn(before, scene);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] < 0) continue;
    const SceneRobot& to = scene.robots[i];
    const SceneRobot& of = before.robots[static_cast<std::size_t>(places[i])];
    const auto into = static_cast<std::size_t>(to.first_channel),
               from = static_cast<std::size_t>(of.first_channel);
    const auto count = static_cast<std::size_t>(std::min(to.channel_count, of.channel_count));
    for (std::size_t k = 0; k < count; ++k) now[into + k] = values[from + k];
  }
  return now;
}

}  // namespace coopdyn
