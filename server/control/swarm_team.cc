// SPDX-License-Identifier: MIT
// Finds the robots of a /swarm request.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "protocol/codec.h"
#include "server/control/swarm_module.h"

namespace coopdyn {

namespace {

/// `robot1 robot2 and 3 more`
std::string ShortList(std::span<const std::string> names) {
  constexpr std::size_t kShown = 10;
  std::string list;
  for (std::size_t i = 0; i < names.size() && i < kShown; ++i) list += (i > 0 ? " " : "") + names[i];
  return names.size() > kShown ? fmt::format("{} and {} more", list, names.size() - kShown) : list;
}

Message NoTeam(command::Id command, const std::string& lost) {
  return ErrorReply(command, Error::kNotPossible,
                    "this connection owns no robots: claim some first, or name them by their ids" +
                        (lost.empty() ? "" : " (" + lost + ")"));
}

}  // namespace

std::string SwarmModule::LostText(std::span<const std::string> lost) {
  return lost.empty() ? "" : "no longer in the team: " + ShortList(lost);
}

std::size_t SwarmModule::MostSensors(const Scene& scene, std::span<const int> rows, std::size_t at_least) {
  std::size_t most = at_least;
  const RobotModel* last = nullptr;  // most robots of a team are of one type
  for (const int robot : rows) {
    if (robot < 0) continue;
    const RobotModel* const model = scene.robots[static_cast<std::size_t>(robot)].entry.model.get();
    if (model == last) continue;
    last = model;
    most = std::max(most, model->sector_count());
  }
  return most;
}

std::optional<Message> SwarmModule::RefuseSize(const Peer& peer, command::Id command, const Scene& scene,
                                               std::span<const int> rows) {
  std::size_t width = 0;
  for (const std::int32_t columns : peer.readings.Columns(scene, MostSensors(scene, rows, peer.sensors)))
    width += static_cast<std::size_t>(columns);
  constexpr std::size_t kOthers = 4096;  // text, params, time_s, step
  const std::size_t bytes = rows.size() * width * sizeof(double);
  if (bytes + kOthers <= kMaxReplyBytes) return std::nullopt;
  return ErrorReply(command, Error::kTooLarge,
                    fmt::format("{} robots with {} columns are more than the 64 MiB of a reply: name fewer "
                                "robots, or select fewer readings",
                                rows.size(), width));
}

std::optional<Message> SwarmModule::FindRows(const Peer& peer, const Message& request,
                                             std::vector<int>& rows) {
  rows.clear();
  if (request.params.empty()) {
    if (peer.team.empty()) return NoTeam(request.command, LostText(peer.lost));
    rows = peer.team;
    return std::nullopt;
  }
  if (++mark_ == 0) {
    std::fill(marks_.begin(), marks_.end(), 0);
    mark_ = 1;
  }
  const std::vector<SceneRobot>& robots = scene_->robots;
  rows.reserve(request.params.size());
  for (const std::int32_t id : request.params) {
    // Ids count from 1; there are gaps only after robots have been removed.
    std::size_t index = static_cast<std::size_t>(id) - 1;
    if (index >= robots.size() || robots[index].id.value != static_cast<std::uint32_t>(id)) {
      const auto found = std::lower_bound(
          robots.begin(), robots.end(), static_cast<std::uint32_t>(id),
          [](const SceneRobot& robot, std::uint32_t wanted) { return robot.id.value < wanted; });
      if (found == robots.end() || found->id.value != static_cast<std::uint32_t>(id)) {
        return ErrorReply(request.command, Error::kNoSuchName,
                          robots.empty() ? "this scenario has no robots"
                                         : fmt::format("there is no robot {}: ids are {} to {}", id,
                                                       robots.front().id.value, robots.back().id.value));
      }
      index = static_cast<std::size_t>(found - robots.begin());
    }
    if (marks_[index] == mark_) {
      return ErrorReply(request.command, Error::kWrongParams,
                        fmt::format("robot {} is named twice: name each robot once", id));
    }
    marks_[index] = mark_;
    rows.push_back(static_cast<int>(index));
  }
  return std::nullopt;
}

std::vector<SlotId> SwarmModule::SlotsOf(std::span<const int> robots) const {
  std::vector<SlotId> slots;
  slots.reserve(robots.size());
  for (const int robot : robots) {
    const SceneRobot& of = scene_->robots[static_cast<std::size_t>(robot)];
    const SlotId* const own = &slots_[static_cast<std::size_t>(of.first_actuator)];
    slots.push_back(own[0]);
    for (int i = 1; i < of.actuator_count; ++i) slots.push_back(own[i]);
  }
  return slots;
}

void SwarmModule::AddSlots(int robot, std::vector<SlotId>& slots) const {
  const SceneRobot& of = scene_->robots[static_cast<std::size_t>(robot)];
  for (int i = of.first_actuator; i < of.first_actuator + of.actuator_count; ++i) {
    slots.push_back(slots_[static_cast<std::size_t>(i)]);
  }
}

void SwarmModule::Refresh(Peer& peer, const Frame& frame, bool quiet) {
  const CommandBoard& board = this->board();
  // Read first: a change during the update is noticed the next time.
  const std::uint64_t layout = board.layout_revision();
  const std::uint64_t revision = board.team_revision();
  if (scene_ != frame.scene || layout_revision_ != layout) {
    scene_ = frame.scene;
    layout_revision_ = layout;
    slots_ = board.FindSlots(*scene_);
    robot_of_slot_.assign(slots_.empty() ? 1 : *std::max_element(slots_.begin(), slots_.end()) + 1, -1);
    for (std::size_t i = 0; i < slots_.size(); ++i) robot_of_slot_[slots_[i]] = scene_->actuators[i].robot;
    robot_of_slot_[0] = -1;
    marks_.assign(scene_->robots.size(), 0);
    mark_ = 0;
  }
  if (peer.scene == scene_ && peer.layout_revision == layout && peer.team_revision == revision) return;
  const std::vector<int> old = std::exchange(peer.team, {});
  const std::shared_ptr<const Scene> old_scene = std::exchange(peer.scene, scene_);
  peer.layout_revision = layout;
  peer.team_revision = revision;
  for (const SlotId slot : board.Team(peer.client.client.id)) {
    const int robot = slot < robot_of_slot_.size() ? robot_of_slot_[slot] : -1;
    if (robot >= 0 && (peer.team.empty() || peer.team.back() != robot)) peer.team.push_back(robot);
  }
  peer.sensors = MostSensors(*scene_, peer.team, 0);
  if (!quiet) NoteLost(peer, old, old_scene);
}

void SwarmModule::NoteLost(Peer& peer, std::span<const int> old,
                           const std::shared_ptr<const Scene>& old_scene) {
  if (old.empty()) return;
  const auto name_in = [](const Scene& scene, int robot) -> const std::string& {
    return scene.robots[static_cast<std::size_t>(robot)].entry.name;
  };
  if (old_scene == peer.scene) {
    std::vector<int> lost;
    std::set_difference(old.begin(), old.end(), peer.team.begin(), peer.team.end(), std::back_inserter(lost));
    for (const int robot : lost) peer.lost.push_back(name_in(*old_scene, robot));
    return;
  }
  std::unordered_set<std::string_view> kept;
  for (const int robot : peer.team) kept.insert(name_in(*peer.scene, robot));
  for (const int robot : old) {
    const std::string& name = name_in(*old_scene, robot);
    if (!kept.contains(name)) peer.lost.push_back(name);
  }
}

void SwarmModule::MoveRows(Peer& peer, const Frame& frame) {
  const std::shared_ptr<const Scene> old = std::exchange(peer.rows_scene, frame.scene);
  if (old == frame.scene) return;
  const std::vector<SceneRobot>& robots = frame.scene->robots;
  for (int& row : peer.rows) {
    const RobotId id = old->robots[static_cast<std::size_t>(row)].id;
    const auto found =
        std::lower_bound(robots.begin(), robots.end(), id,
                         [](const SceneRobot& robot, RobotId wanted) { return robot.id < wanted; });
    row = found == robots.end() || found->id != id ? -1 : static_cast<int>(found - robots.begin());
  }
}

}  // namespace coopdyn
