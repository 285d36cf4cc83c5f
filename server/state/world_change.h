// SPDX-License-Identifier: MIT
// An edit of the world, in the one form that the stepping thread, the journal, undo and repetitions share:
// the things to remove, and those to add or to replace by id. Needs no files. Plain values and pure
// functions; any thread.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/state/frame.h"

namespace coopdyn {

/// Where an edit puts a thing.
enum class Placing : std::uint8_t {
  kStart,  // at rest at the pose of its description
  kKeep,   // keeps its present pose and motion: only its description changes
  kExact,  // at the states given with it
};

struct PutObject {
  ObjectId id;  // none: a new one
  WorldObject object;
  Placing placing = Placing::kStart;
  std::optional<BodyState> body = {};  // kExact and dynamic only
};

struct PutRobot {
  RobotId id;  // none: a new one
  RobotEntry entry;
  Placing placing = Placing::kStart;
  // kExact only:
  std::vector<BodyState> bodies = {};
  std::vector<ChannelState> channels = {};
  std::vector<JointControl> controls = {};
  std::vector<DriveTrainState> drive_trains = {};
  std::vector<double> measured = {};
};

/// Ids of /world: things from 1, robots from kRobots + 1, and so on.
struct WorldId {
  static constexpr std::int32_t kRobots = 1'000'000, kTargets = 2'000'000, kLights = 3'000'000;
  static constexpr std::int32_t kMost = 999'999;  // per kind
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
/// The id of the light at index `place` of the scene's lights.
inline std::int32_t LightId(std::size_t place) {
  return WorldId::kLights + static_cast<std::int32_t>(place) + 1;
}

/// How long a dynamic thing has been at rest.
struct RestCounter {
  std::int32_t id = 0;  // WorldId
  std::uint64_t counter = 0;
};

/// Prefix of the labels of the supervisor's changes, and of no others.
inline constexpr const char* kSupervisorLabel = "supervisor ";

struct WorldChange {
  std::string label;  // for people: "insert BOX_1"
  std::vector<ObjectId> gone_objects;
  std::vector<RobotId> gone_robots;
  std::vector<TargetId> gone_targets;
  std::vector<PutObject> objects;
  std::vector<PutRobot> robots;
  std::vector<Target> targets;                         // id: none, a new one
  std::optional<std::vector<PointLight>> lights = {};  // replaces all lights
  std::vector<RestCounter> rests = {};                 // of unchanged things: an immediate undo restores
                                                       // their sleep

  bool empty() const {
    return gone_objects.empty() && gone_robots.empty() && gone_targets.empty() && objects.empty() &&
           robots.empty() && targets.empty() && !lights;
  }
};

/// A target's name in /world and in legends: red_target_1.
std::string TargetName(const Target& target);

/// Gives new things the next ids after those of `scene` and `used`, and updates `used`.
struct UsedIds {
  std::uint32_t object = 0, robot = 0, target = 0;
};
void AssignIds(const Scene& scene, UsedIds& used, WorldChange& change);

/// The scene after `change`, whose things have ids. Null, with the reason in `refusal`, if it is not
/// possible: a name in use, an unknown id, too many things.
std::shared_ptr<const Scene> ChangedScene(const Scene& scene, const WorldChange& change,
                                          std::string& refusal);

/// `from` converted to `scene`: things in both scenes keep their state; new ones take theirs from `other`, a
/// frame of `scene`, or if null stand at the origin at rest. Omits contacts with removed things.
std::shared_ptr<Frame> InScene(const Frame& from, const std::shared_ptr<const Scene>& scene,
                               const Frame* other = nullptr);

/// The change that undoes `change`, applied to the scene that `change` makes of `before`.
WorldChange InverseOf(const WorldChange& change, const Frame& before);

/// For each robot of `scene` its index in `before`, by id; -1 if it is new.
std::vector<int> PlacesIn(const Scene& before, const Scene& scene);

/// Rearranges values of the channels of `before` for those of `scene`; new channels get `fresh`.
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
