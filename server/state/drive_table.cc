// SPDX-License-Identifier: MIT
#include "server/state/drive_table.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

namespace {

/// Overwrites the channels that `commanded` sets; keeps the others.
void Merge(std::span<const Setpoint> commanded, std::span<Setpoint> channels) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (commanded[i].mode != ControlMode::kKeep) channels[i] = commanded[i];
  }
}

}  // namespace

bool Client::SpeaksFor(const Client& owner) const {
  if (id == owner.id || IsAllyOf(owner)) return true;
  const auto host = [](const Client& client) { return client.peer.substr(0, client.peer.rfind(':')); };
  if (owner.name.empty()) return name.empty() && host(*this) == host(owner);
  return name == owner.name || name.starts_with(owner.name + ":");
}

std::vector<DriveTable::Leaving> DriveTable::Revise(const Scene& scene, std::span<const int> unloaded) {
  DriveTable old = *this;
  Configure(scene, true, unloaded);
  std::vector<Leaving> left;
  for (std::size_t i = 0; i < old.size(); ++i) {
    const Drive& was = old.drives_[i];
    const std::size_t now = Find(old.slots_[i].id);
    const bool same = now != kNoSlot && drives_[now].driven == was.driven &&
                      drives_[now].channel_count == was.channel_count;
    if (!same) {
      left.push_back({was.has_done ? std::move(old.slots_[i].done) : nullptr, was.batch});
      continue;
    }
    Drive& drive = drives_[now];
    const Drive fresh = drive;
    drive = was;
    drive.robot = fresh.robot;
    drive.first_channel = fresh.first_channel;
    Slot& slot = slots_[now];
    if (slot.may_participate != old.slots_[i].may_participate) drive.participates = slot.may_participate;
    slot.done = std::move(old.slots_[i].done);
    slot.message = old.slots_[i].message;
    std::ranges::copy(old.Of(i, old.in_force_), Of(now, in_force_).begin());
    std::ranges::copy(old.Of(i, old.commanded_), Of(now, commanded_).begin());
  }
  return left;
}

void DriveTable::Configure(const Scene& scene, bool keep_participants, std::span<const int> unloaded) {
  const DriveTable old = std::exchange(*this, {});
  next_slot_ = old.next_slot_;
  slots_.reserve(scene.actuators.size());
  drives_.reserve(scene.actuators.size());
  for (const SceneActuator& actuator : scene.actuators) {
    const auto robot = static_cast<std::size_t>(actuator.robot);
    const RobotEntry& entry = scene.robots[robot].entry;
    const std::vector<std::string> awaited = entry.awaited_modules();
    Slot slot;
    slot.robot = entry.name;
    slot.type = entry.model->type;
    slot.module = actuator.module;
    slot.controller = entry.controller.name;
    slot.deadline_s = entry.deadline_s;
    slot.on_deadline = entry.on_deadline;
    slot.on_disconnect = entry.on_disconnect;
    slot.watchdog_s = entry.watchdog_s ? entry.watchdog_s : scene.scenario->simulation.watchdog_s;
    if (entry.runs_without_client()) slot.watchdog_s = 0;
    slot.may_be_awaited = std::ranges::find(awaited, actuator.module) != awaited.end();
    slot.may_participate = entry.sync && slot.may_be_awaited;
    Drive drive;
    drive.robot = static_cast<std::uint32_t>(robot);
    drive.first_channel = static_cast<std::uint32_t>(actuator.first_channel);
    drive.channel_count = static_cast<std::uint32_t>(actuator.channel_count);
    drive.has_module = !actuator.module.empty() || entry.model->is_only_observed();
    drive.driven =
        !entry.controller.empty() && !std::ranges::binary_search(unloaded, static_cast<int>(robot));
    drive.participates = !drive.driven && slot.may_participate;
    has_deadlines_ |= slot.deadline_s.has_value();

    const std::optional<std::size_t> named = old.FindRobot(slot.robot);
    const std::size_t before =
        named ? old.first_slots_[*named] + slots_.size() - first_slots_[robot] : kNoSlot;
    if (before < old.size() && old.slots_[before].robot == slot.robot &&
        old.slots_[before].type == slot.type && old.slots_[before].module == slot.module) {
      const Slot& same = old.slots_[before];
      slot.id = same.id;
      if (!drive.driven) {
        drive.owner = old.drives_[before].owner;
        slot.owner = same.owner;
        slot.heard = same.heard;
        slot.former = same.former;
        if (keep_participants) drive.participates = old.drives_[before].participates;
      }
    } else {
      slot.id = next_slot_++;
    }
    by_name_.emplace(slot.robot, robot);
    slots_.push_back(std::move(slot));
    drives_.push_back(drive);
    first_slots_.resize(robot + 2);
    first_slots_.back() = slots_.size();
  }
  in_force_.resize(scene.channels.size());
  commanded_ = in_force_;
  slot_index_.assign(next_slot_, kNoSlot);
  for (std::size_t i = 0; i < slots_.size(); ++i) slot_index_[slots_[i].id] = i;
}

std::optional<std::size_t> DriveTable::FindRobot(const std::string& name) const {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? std::nullopt : std::optional(found->second);
}

SlotId DriveTable::FindSlot(const std::string& robot, const std::string& module) const {
  const std::optional<std::size_t> found = FindRobot(robot);
  if (!found) return 0;
  const std::size_t first = first_slots_[*found];
  for (std::size_t i = first; !module.empty() && i < first_slots_[*found + 1]; ++i) {
    if (slots_[i].module == module) return slots_[i].id;
  }
  return slots_[first].id;
}

std::string DriveTable::Who(std::size_t index) const {
  const Slot& slot = slots_[index];
  return drives_[index].driven ? "controller " + slot.controller : slot.owner.shown();
}

std::string DriveTable::NameOf(std::size_t index) const {
  const std::size_t robot = drives_[index].robot;
  const bool several = first_slots_[robot + 1] - first_slots_[robot] > 1;
  return several ? slots_[index].robot + "/" + slots_[index].module : slots_[index].robot;
}

std::string DriveTable::NamesOfRobots() const {
  constexpr std::size_t kNamed = 8;
  const std::size_t robots = robot_count();
  if (robots == 0) return "there are no robots";
  std::string names = "there are";
  for (std::size_t i = 0; i < std::min(kNamed, robots); ++i) {
    names += (i == 0 ? " " : ", ") + slots_[first_slots_[i]].robot;
  }
  if (robots > kNamed) names += " and " + std::to_string(robots - kNamed) + " more (list shows all)";
  return names;
}

std::string DriveTable::CureForNoClient() const {
  const auto lacks_client = [](const Drive& drive) { return drive.is_awaited() && drive.owner == 0; };
  const bool several = std::ranges::count_if(drives_, lacks_client) > 1;
  constexpr std::size_t kNamed = 4;
  std::string names;
  std::size_t count = 0;
  for (std::size_t robot = 0; robot < robot_count() && count <= kNamed; ++robot) {
    const std::span<const Drive> own(drives_.begin() + static_cast<std::ptrdiff_t>(first_slots_[robot]),
                                     drives_.begin() + static_cast<std::ptrdiff_t>(first_slots_[robot + 1]));
    const bool has_client = std::ranges::any_of(own, [](const Drive& drive) { return drive.owner != 0; });
    if (!has_client || std::ranges::any_of(own, lacks_client)) continue;
    if (++count <= kNamed) names += " " + slots_[first_slots_[robot]].robot;
  }
  const std::string start = several ? "start their programs" : "start its program";
  if (count == 0) return start + ", or set_mode realtime";
  const std::string others = count <= kNamed ? names : " and the names of the robots that have one";
  return start + ", or let the others go on with set_participants" + others +
         ", or the page's button 'connected'";
}

ClientId DriveTable::TakeOver(std::size_t index, const Client& client) {
  Drive& drive = drives_[index];
  if (drive.owner == 0) return 0;
  Client& owner = slots_[index].owner;
  if (drive.owner == client.id) {
    owner.name = client.name;
    return 0;
  }
  if (client.name.empty() || owner.name != client.name || owner.is_team != client.is_team) return 0;
  owner = client;
  slots_[index].heard.reset();
  return std::exchange(drive.owner, client.id);
}

void DriveTable::SetPending(std::size_t index, ClientId client, std::span<const Setpoint> setpoints,
                            int steps) {
  Drive& drive = drives_[index];
  drive.excused = drive.dropped = drive.abandoned = false;
  if (!setpoints.empty()) {
    drive.silenced = false;
    const bool adds = drive.pending && drive.has_setpoint && !drive.latched;
    if (adds) {
      Merge(setpoints, Of(index, commanded_));
    } else {
      std::ranges::copy(setpoints, Of(index, commanded_).begin());
    }
    drive.has_setpoint = true;
  } else if (!drive.pending) {
    drive.has_setpoint = false;
  }
  drive.pending = true;
  drive.latched = false;  // a step that runs now did not latch it
  drive.pending_from = client;
  drive.batch = 0;
  drive.steps_left = steps;
}

void DriveTable::Latch(std::span<std::uint8_t> commanded) {
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    Drive& drive = drives_[i];
    commanded[i] = static_cast<std::uint8_t>(drive.pending && drive.has_setpoint && !drive.latched);
    if (!drive.pending) continue;
    if (drive.has_setpoint) Merge(Of(i, commanded_), Of(i, in_force_));
    drive.latched = true;
  }
}

bool DriveTable::Moves(std::size_t index) const {
  return std::ranges::any_of(Of(index, in_force_), &Setpoint::drives);
}

void DriveTable::Stop(std::size_t index) {
  for (Setpoint& setpoint : Of(index, in_force_)) setpoint = setpoint.stopped();
}

void DriveTable::StopPending(std::size_t index) {
  Stop(index);
  Drive& drive = drives_[index];
  if (!drive.pending) return;
  if (!drive.has_setpoint) std::ranges::copy(Of(index, in_force_), Of(index, commanded_).begin());
  for (Setpoint& setpoint : Of(index, commanded_)) setpoint = setpoint.stopped();
  drive.has_setpoint = true;
}

void DriveTable::ApplyPolicy(std::size_t index, LossPolicy policy) {
  Drive& drive = drives_[index];
  if (policy == LossPolicy::kStop || policy == LossPolicy::kDrop) Stop(index);
  if (policy == LossPolicy::kHold || policy == LossPolicy::kStop) drive.excused = true;
  if (policy == LossPolicy::kDrop) drive.dropped = true;
}

}  // namespace coopdyn
