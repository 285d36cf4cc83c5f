// SPDX-License-Identifier: MIT
// What /simulation tells: the part of the module that reads.
#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "server/control/simulation_module.h"
#include "server/control/status_json.h"

namespace coopdyn {

namespace {

StatusInput::Robot DescribeRobot(const SceneRobot& robot, const CommandBoard::Owner* owner,
                                 const NameTable& names) {
  StatusInput::Robot line;
  line.name = robot.entry.name;
  line.type = robot.entry.model->type;
  for (const ModuleModel& module : robot.entry.model->modules) {
    const std::string path = "/" + line.name + "/" + module.name;
    const std::optional<NameEntry> entry = names.Find(path);
    line.modules.push_back({path, module.type, entry ? entry->port : 0});
  }
  if (owner != nullptr) {
    if (owner->id != 0 || owner->driven) line.owner = owner->name;
    line.participates = owner->participates;
    line.dropped = owner->dropped;
    line.still_moving = owner->still_moving;
  }
  return line;
}

}  // namespace

std::string SimulationModule::StatusText(const Frame& frame, std::size_t first, std::size_t count) const {
  const Scene& scene = *frame.scene;
  StatusInput status;
  status.version = services_.version;
  status.scenario = scene.scenario->name;
  status.seed = frame.seed;
  status.run = services_.run.status();
  status.step = frame.step;
  status.revision = frame.revision;
  status.time_s = frame.time_s();
  status.hash = HashText(StateHash(frame));
  status.events = services_.run.events();
  status.recording = services_.actions.recording();
  status.recording_lost = services_.actions.recording_lost();
  status.recording_stall = services_.actions.recording_stall();
  status.http = services_.actions.http();
  status.awaiting = services_.board.Awaiting(services_.clock.Now(), kMaxAwaited, &status.awaiting_count);
  status.playback = services_.run.playback();
  if (status.playback) {
    status.run.state = status.playback->playing ? RunState::kPlaying : RunState::kPaused;
  } else if (status.run.state == RunState::kRunning && status.awaiting_count > 0) {
    status.run.state = RunState::kWaiting;
  }

  const std::vector<CommandBoard::Owner> owners = services_.board.Owners();
  std::unordered_map<std::string_view, const CommandBoard::Owner*> owner_of;
  std::unordered_set<ClientId> owning;
  for (const CommandBoard::Owner& owner : owners) {
    owner_of.emplace(owner.robot, &owner);
    if (owner.id != 0) owning.insert(owner.id);
  }
  status.robot_count = scene.robots.size();
  for (std::size_t i = first - 1; i < scene.robots.size() && status.robots.size() < count; ++i) {
    const auto owner = owner_of.find(scene.robots[i].entry.name);
    status.robots.push_back(
        DescribeRobot(scene.robots[i], owner == owner_of.end() ? nullptr : owner->second, services_.names));
  }
  for (ConnectionRoster::Entry& entry : services_.roster.List(kMaxListed, status.client_count)) {
    const bool is_owner = owning.contains(entry.id);
    status.clients.push_back({std::move(entry), is_owner});
  }
  return StatusJson(status);
}

Message SimulationModule::Read(const Message& request, const Frame& frame) {
  if (request.command == command::kGetSaved) return ReadSaved(request);
  Message reply = ReplyTo(request.command);
  reply.text = request.params.size() == 2 ? StatusText(frame, static_cast<std::size_t>(request.params[0]),
                                                       static_cast<std::size_t>(request.params[1]))
                                          : StatusText(frame);
  return reply;
}

}  // namespace coopdyn
