// SPDX-License-Identifier: MIT
#include "server/control/status_json.h"

#include <boost/json.hpp>
#include <cmath>
#include <filesystem>

#include "protocol/command_table.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

json::value Number(double value) {
  return std::isfinite(value) ? json::value(value) : json::value(nullptr);
}

json::value Text(const std::string& text) {
  return text.empty() ? json::value(nullptr) : json::value(json::string(text));
}

json::array Robots(const std::vector<StatusInput::Robot>& robots) {
  json::array list;
  for (const StatusInput::Robot& robot : robots) {
    json::array modules;
    for (const StatusInput::Module& module : robot.modules) {
      modules.push_back({{"name", module.name}, {"type", module.type}, {"port", module.port}});
    }
    list.push_back({{"name", robot.name},
                    {"type", robot.type},
                    {"modules", std::move(modules)},
                    {"owner", Text(robot.owner)},
                    {"participates", robot.participates},
                    {"dropped", robot.dropped},
                    {"still_moving", robot.still_moving}});
  }
  return list;
}

json::array Clients(const std::vector<StatusInput::Connection>& clients) {
  json::array list;
  for (const StatusInput::Connection& client : clients) {
    list.push_back({{"module", client.entry.module},
                    {"peer", client.entry.peer},
                    {"name", Text(client.entry.name)},
                    {"owner", client.owner}});
  }
  return list;
}

json::array Awaiting(const std::vector<Awaited>& awaiting) {
  json::array list;
  for (const Awaited& awaited : awaiting) {
    list.push_back({{"robot", awaited.robot},
                    {"why", awaited.why},
                    {"seconds", Number(awaited.seconds)},
                    {"cure", Text(awaited.cure)}});
  }
  return list;
}

json::array Events(const std::vector<Event>& events) {
  json::array list;
  for (const Event& event : events) {
    list.push_back({{"step", event.step},
                    {"time_s", Number(event.time_s)},
                    {"level", event.level},
                    {"text", event.text}});
  }
  return list;
}

json::value Playback(const std::optional<PlaybackStatus>& playback) {
  if (!playback) return nullptr;
  return json::object{{"file", std::filesystem::path(playback->file).filename().string()},
                      {"playing", playback->playing},
                      {"loop", playback->loop},
                      {"growing", playback->growing},
                      {"speed", Number(playback->speed)},
                      {"time_s", Number(ToSeconds(playback->time))},
                      {"step", playback->step},
                      {"begin_s", Number(ToSeconds(playback->begin))},
                      {"end_s", Number(ToSeconds(playback->end))},
                      {"begin_step", playback->begin_step},
                      {"end_step", playback->end_step}};
}

}  // namespace

std::string StatusJson(const StatusInput& status) {
  const RunStatus& run = status.run;
  json::array frozen;
  for (const std::string& name : run.frozen) frozen.push_back(json::string(name));
  const json::object object{
      {"version", status.version},
      {"protocol", kProtocolVersion},
      {"scenario", Text(status.scenario)},
      {"seed", status.seed},
      {"mode", ToString(run.mode)},
      {"state", ToString(run.state)},
      {"step", status.step},
      {"revision", status.revision},
      {"time_s", Number(status.time_s)},
      {"step_s", Number(ToSeconds(run.step_length))},
      {"speed", run.speed > 0 ? Number(run.speed) : json::value(nullptr)},
      {"rtf", Number(run.real_time_factor)},
      {"late_periods", run.late_periods},
      {"hash", Text(status.hash)},
      {"robots", Robots(status.robots)},
      {"robot_count", status.robot_count},
      {"clients", Clients(status.clients)},
      {"client_count", status.client_count},
      {"awaiting", Awaiting(status.awaiting)},
      {"awaiting_count", status.awaiting_count},
      {"frozen", std::move(frozen)},
      {"recording", Text(status.recording)},
      {"recording_lost", status.recording_lost},
      {"recording_stalled", Text(status.recording_stall)},
      {"playback", Playback(status.playback)},
      {"http", Text(status.http)},
      {"events", Events(status.events)},
  };
  return json::serialize(object);
}

}  // namespace coopdyn
