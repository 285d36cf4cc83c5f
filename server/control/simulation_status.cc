// SPDX-License-Identifier: MIT
// Readings of /simulation. get_status is one JSON object (docs/protocol.md). All objects of a list have the
// same keys; absent or non-finite values are null.
#include <algorithm>
#include <boost/json.hpp>
#include <filesystem>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "protocol/command_table.h"
#include "protocol/json_text.h"
#include "server/control/score_json.h"
#include "server/control/simulation_module.h"

namespace coopdyn {

namespace {

namespace json = boost::json;
using Owner = CommandBoard::Owner;

json::value Text(const std::string& text) {
  return text.empty() ? json::value(nullptr) : json::value(json::string(text));
}

/// `owner`: the robot's; null: the board has no such robot.
json::object RobotJson(const SceneRobot& robot, const Owner* owner, const NameTable& names, Nanoseconds now) {
  json::array modules;
  for (const ModuleModel& module : robot.entry.model->modules()) {
    const std::string path = "/" + robot.entry.name + "/" + module.name;
    const std::optional<NameEntry> entry = names.Find(path);
    modules.push_back({{"name", path}, {"type", module.type}, {"port", entry ? entry->port : 0}});
  }
  const bool owned = owner != nullptr && (owner->id != 0 || owner->driven);
  return {
      {"name", robot.entry.name},
      {"type", robot.entry.model->type},
      {"modules", std::move(modules)},
      {"owner", owned ? Text(owner->name) : nullptr},
      {"controller", owner != nullptr && owner->driven ? Text(robot.entry.controller.name) : nullptr},
      {"participates", owner != nullptr && owner->participates},
      {"dropped", owner != nullptr && owner->dropped},
      {"still_moving", owner != nullptr && owner->still_moving},
      {"silent_s", owner != nullptr && owner->heard ? json::value(ToSeconds(now - *owner->heard)) : nullptr},
      {"watchdog_stopped", owner != nullptr && owner->silenced}};
}

json::value PlaybackJson(const std::optional<PlaybackStatus>& playback) {
  if (!playback) return nullptr;
  return json::object{{"file", std::filesystem::path(playback->file).filename().string()},
                      {"playing", playback->playing},
                      {"loop", playback->loop},
                      {"growing", playback->growing},
                      {"speed", playback->speed},
                      {"time_s", ToSeconds(playback->time)},
                      {"step", playback->step},
                      {"begin_s", ToSeconds(playback->begin)},
                      {"end_s", ToSeconds(playback->end)},
                      {"begin_step", playback->begin_step},
                      {"end_step", playback->end_step}};
}

}  // namespace

std::string SimulationModule::StatusText(const Frame& frame, std::size_t first, std::size_t count) const {
  const Scene& scene = *frame.scene;
  const std::vector<Owner> owners = services_.board.Owners();
  std::unordered_map<std::string_view, const Owner*> owner_of;
  std::unordered_set<ClientId> owning;
  for (const Owner& owner : owners) {
    owner_of.emplace(owner.robot, &owner);
    if (owner.id != 0) owning.insert(owner.id);
  }
  const Nanoseconds now = services_.clock.Now();
  json::array robots;
  for (std::size_t i = first - 1; i < scene.robots.size() && robots.size() < count; ++i) {
    const auto owner = owner_of.find(scene.robots[i].entry.name);
    robots.push_back(
        RobotJson(scene.robots[i], owner == owner_of.end() ? nullptr : owner->second, services_.names, now));
  }
  json::array clients;
  std::size_t client_count = 0;
  for (const ConnectionRoster::Entry& client : services_.roster.List(kMaxListed, client_count)) {
    clients.push_back({{"module", client.module},
                       {"peer", client.peer},
                       {"name", Text(client.name)},
                       {"owner", owning.contains(client.id)}});
  }
  json::array awaiting;
  std::size_t awaiting_count = 0;
  for (const Awaited& awaited : services_.board.Awaiting(now, kMaxAwaited, &awaiting_count)) {
    awaiting.push_back({{"robot", awaited.robot},
                        {"why", awaited.why},
                        {"seconds", awaited.seconds},
                        {"cure", Text(awaited.cure)}});
  }
  json::array events;
  for (const Event& event : services_.run.events()) {
    events.push_back(
        {{"step", event.step}, {"time_s", event.time_s}, {"level", event.level}, {"text", event.text}});
  }

  const RunStatus run = services_.run.status();
  const std::optional<PlaybackStatus> playback = services_.run.playback();
  RunState state = run.state;
  if (playback) {
    state = playback->playing ? RunState::kPlaying : RunState::kPaused;
  } else if (state == RunState::kRunning && awaiting_count > 0) {
    state = RunState::kWaiting;
  }
  return JsonText(json::object{
      {"version", services_.version},
      {"protocol", kProtocolVersion},
      {"scenario", Text(scene.scenario->name)},
      {"seed", frame.seed},
      {"mode", ToString(run.mode)},
      {"state", ToString(state)},
      {"ended", Text(run.ended)},
      {"step", frame.step},
      {"revision", frame.revision},
      {"time_s", frame.time_s()},
      {"step_s", ToSeconds(run.step_length)},
      {"speed", run.speed > 0 ? json::value(run.speed) : nullptr},
      {"rtf", run.real_time_factor},
      {"late_periods", run.late_periods},
      {"hash", HashText(StateHash(frame))},
      {"scores", ScoresJson(frame)},
      {"logged", LoggedJson(services_.run.logged())},
      {"robots", std::move(robots)},
      {"robot_count", scene.robots.size()},
      {"clients", std::move(clients)},
      {"client_count", client_count},
      {"awaiting", std::move(awaiting)},
      {"awaiting_count", awaiting_count},
      {"frozen", json::value_from(run.frozen)},
      {"unsolved", run.unsolved},
      {"recording", Text(services_.actions.recording())},
      {"recording_lost", services_.actions.recording_lost()},
      {"recording_stalled", Text(services_.actions.recording_stall())},
      {"playback", PlaybackJson(playback)},
      {"http", Text(services_.actions.http())},
      {"events", std::move(events)},
  });
}

Message SimulationModule::Read(const Message& request, const Frame& frame) {
  if (request.command == command::kGetSaved) return ReadSaved(request);
  if (request.command == command::kGetClock) {
    Message clock = ReplyTo(request.command);
    clock.params = {static_cast<std::int32_t>(frame.time / kNanosecondsPerSecond),
                    static_cast<std::int32_t>(frame.time % kNanosecondsPerSecond)};
    clock.data = {ToSeconds(services_.run.status().step_length)};
    return clock;
  }
  const std::vector<std::int32_t>& params = request.params;
  const std::size_t first = params.empty() ? 1 : static_cast<std::size_t>(params[0]);
  const std::size_t count = params.size() < 2 ? kMaxListed : static_cast<std::size_t>(params[1]);
  return ReplyTo(request.command, StatusText(frame, first, count));
}

}  // namespace coopdyn
