// SPDX-License-Identifier: MIT
#include "server/app/info_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <boost/json.hpp>
#include <memory>
#include <sstream>
#include <utility>

#include "protocol/json_text.h"
#include "server/app/commands.h"
#include "server/app/print.h"
#include "server/base/printable.h"
#include "server/record/run_open.h"
#include "server/replay/verify_chain.h"

namespace coopdyn {

namespace {

constexpr std::size_t kMostNames = 10;

std::string Size(double bytes) {
  constexpr std::pair<double, const char*> kUnits[] = {{1e9, "GB"}, {1e6, "MB"}, {1e3, "kB"}};
  for (const auto& [factor, unit] : kUnits) {
    if (bytes >= factor) return fmt::format("{:.1f} {}", bytes / factor, unit);
  }
  return fmt::format("{:.0f} bytes", bytes);
}

/// "1 robot", "2 robots".
std::string Count(std::uint64_t count, const std::string& thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

std::string RobotNames(const std::vector<RunContents::Robot>& robots) {
  std::string names;
  for (std::size_t i = 0; i < std::min(robots.size(), kMostNames); ++i) {
    names += fmt::format("{}{} ({})", i == 0 ? "" : ", ", robots[i].name, robots[i].type);
  }
  if (robots.size() > kMostNames) names += fmt::format(", and {} more", robots.size() - kMostNames);
  return names.empty() ? "none" : names;
}

double Duration(const RunInfo& info) {
  return ToSeconds(info.extent.end - info.extent.begin);
}

double BytesPerStep(const RunInfo& info) {
  return static_cast<double>(info.contents.bytes) / static_cast<double>(info.extent.steps + 1);
}

std::size_t Notes(const RunInfo& info) {
  return static_cast<std::size_t>(std::count_if(info.events.begin(), info.events.end(),
                                                [](const Event& event) { return event.level == "note"; }));
}

/// "recorded poses,channels each 0.1 s".
std::string What(const RunHeader& header) {
  std::string what = ToString(header.what);
  if (header.pose_every > 0)
    what += fmt::format(", poses and readings each {:.10g} s", ToSeconds(header.pose_every));
  return what;
}

/// "diffuse (hash 0123456789abcdef)".
std::string WithHashes(const std::vector<PluginHash>& files) {
  std::string text;
  for (const PluginHash& one : files) {
    text += fmt::format("{}{} (hash {})", text.empty() ? "" : ", ", Printable(one.name), Printable(one.hash));
  }
  return text;
}

std::string LostText(const RunExtent& extent) {
  std::string text = extent.lost == 0 ? "no steps" : Count(extent.lost, "step");
  if (extent.lost_after > 0)
    text += fmt::format(", and {} after the last one", Count(extent.lost_after, "step"));
  return text;
}

std::string LogText(const RunInfo& info) {
  const std::string why = info.log_reason.empty() ? "" : " (" + info.log_reason + ")";
  return info.log + " is not part of the file yet" + why + ": copy both";
}

constexpr std::size_t kMaxEventBytes = 4000;  // longer texts are cut

/// Adds an event; indents further lines of its text, and makes it printable.
void AddEvent(std::string& text, const Event& event) {
  text += fmt::format("    {:>10.3f} s  {:<8}", event.time_s, event.level);
  const std::string below(26, ' ');
  for (const char c : PrintableLines(event.text, kMaxEventBytes)) {
    text += c;
    if (c == '\n') text += below;
  }
  text += '\n';
}

void AddLine(std::string& text, const char* name, const std::string& value) {
  if (!value.empty()) text += fmt::format("  {:<10}{}\n", name, Printable(value, 4000));
}

}  // namespace

std::optional<RunInfo> ReadRunInfo(const std::string& file, bool count_commands, std::string& error) {
  const auto reader = RunReader::Open(file, error);
  if (reader == nullptr) return std::nullopt;
  RunInfo info;
  info.file = file;
  info.header = reader->header();
  info.extent = reader->extent();
  info.mended = reader->mended();
  info.growing = reader->growing();
  info.log = UnmergedLog(reader->file());
  if (!info.log.empty()) info.log_reason = reader->log_reason();
  const std::optional<RunContents> contents = reader->Contents();
  if (contents) {
    info.contents = *contents;
    const bool counts = count_commands || contents->bytes <= kCountCommandsBytes;
    if (counts) info.commands = reader->CountCommands();
    if (!counts || info.commands) info.events = reader->Events();
    if (counts && reader->error().empty()) {
      info.damage = WhyDamaged(*reader, info.extent.first, info.extent.last);
    }
  }
  if (reader->error().empty()) return info;
  error = reader->error();
  return std::nullopt;
}

std::string ToText(const RunInfo& info, bool all_events) {
  const RunHeader& header = info.header;
  const RunExtent& extent = info.extent;
  std::string text = fmt::format("{}: {:.10g} s, {}, {}\n", info.file, Duration(info),
                                 Count(extent.steps, "step"), Count(info.contents.robots.size(), "robot"));
  if (info.mended) text += "  mended: the recording had not been closed\n";
  if (info.growing) text += "  it is being recorded at this moment\n";
  if (!info.log.empty()) AddLine(text, "log", LogText(info));
  AddLine(text, "time",
          fmt::format("{:.10g} to {:.10g} s, steps {} to {}", ToSeconds(extent.begin), ToSeconds(extent.end),
                      extent.first, extent.last));
  AddLine(text, "scenario",
          fmt::format("{}, seed {}, {}, steps of {} ms", header.scenario_name, header.seed,
                      ToString(header.mode), static_cast<double>(header.step_length) * 1e-6));
  AddLine(text, "robots", RobotNames(info.contents.robots));
  AddLine(text, "recorded", What(header));
  AddLine(text, "size",
          fmt::format("{}, {:.0f} bytes per step, {}", Size(static_cast<double>(info.contents.bytes)),
                      BytesPerStep(info), Count(info.contents.keyframes, "keyframe")));
  const std::string commands =
      info.commands ? Count(*info.commands, "command") : "commands not counted (--count-commands)";
  AddLine(text, "inputs", fmt::format("{}, {}", commands, Count(info.contents.inputs, "other input")));
  AddLine(text, "lost", LostText(extent));
  if (extent.missing > 0) {
    AddLine(text, "missing", Count(extent.missing, "step") + " at the end: the file is damaged");
  }
  AddLine(text, "damaged", Printable(info.damage));
  AddLine(text, "made by",
          fmt::format("coopdyn {} (build {}), {}{}", header.version, header.build, header.started,
                      header.cpu.empty() ? "" : ", on " + header.cpu));
  AddLine(text, "libraries", WithHashes(header.libraries));
  AddLine(text, "plug-ins", WithHashes(header.controllers));
  AddLine(text, "command", header.command);
  AddLine(text, "last hash", HashText(info.contents.last_hash));
  const std::size_t notes = Notes(info);
  const bool hidden = !all_events && info.events.size() > notes;
  AddLine(text, "events",
          fmt::format("{}, {}{}", info.events.size(), Count(notes, "note"),
                      hidden ? "; --events lists them all" : ""));
  for (const Event& event : info.events) {
    if (!all_events && event.level != "note") continue;
    AddEvent(text, event);
  }
  return text;
}

std::string ToJson(const RunInfo& info) {
  namespace json = boost::json;
  const RunHeader& header = info.header;
  json::array robots, events;
  for (const RunContents::Robot& robot : info.contents.robots) {
    robots.push_back({{"name", robot.name}, {"type", robot.type}});
  }
  for (const Event& event : info.events) {
    events.push_back(
        {{"step", event.step}, {"time_s", event.time_s}, {"level", event.level}, {"text", event.text}});
  }
  json::object object;
  object["file"] = info.file;
  object["mended"] = info.mended;
  object["growing"] = info.growing;
  object["log"] = info.log.empty() ? json::value(nullptr) : json::value(info.log);
  object["log_reason"] = info.log.empty() ? json::value(nullptr) : json::value(info.log_reason);
  object["duration_s"] = Duration(info);
  object["begin_s"] = ToSeconds(info.extent.begin);
  object["end_s"] = ToSeconds(info.extent.end);
  object["first_step"] = info.extent.first;
  object["last_step"] = info.extent.last;
  object["steps"] = info.extent.steps;
  object["lost"] = info.extent.lost;
  object["lost_after"] = info.extent.lost_after;
  object["missing"] = info.extent.missing;
  object["damaged"] = info.damage.empty() ? json::value(nullptr) : json::value(info.damage);
  object["scenario"] = header.scenario_name;
  object["seed"] = std::to_string(header.seed);
  object["mode"] = ToString(header.mode);
  object["step_s"] = ToSeconds(header.step_length);
  object["recorded"] = ToString(header.what);
  object["pose_every_s"] = ToSeconds(header.pose_every);
  object["bytes"] = info.contents.bytes;
  object["bytes_per_step"] = BytesPerStep(info);
  object["bodies"] = info.contents.bodies;
  object["keyframes"] = info.contents.keyframes;
  object["commands"] = info.commands ? json::value(*info.commands) : json::value(nullptr);
  object["inputs"] = info.contents.inputs;
  object["version"] = header.version;
  object["build"] = header.build;
  object["cpu"] = header.cpu;
  const auto hashes = [](const std::vector<PluginHash>& files) {
    json::object of;
    for (const PluginHash& one : files) of[one.name] = one.hash;
    return of;
  };
  object["controllers"] = hashes(header.controllers);
  object["libraries"] = hashes(header.libraries);
  object["digests"] = json::value_from(DigestsOf(header));
  object["started"] = header.started;
  object["command"] = header.command;
  object["last_hash"] = HashText(info.contents.last_hash);
  object["robots"] = std::move(robots);
  object["events"] = std::move(events);
  return JsonText(object);
}

int Info(const InfoOptions& options, std::ostream& out, std::ostream& errors) {
  bool failed = false, first = true;
  if (options.json) out << '[';
  for (const std::string& file : options.files) {
    std::string error;
    const std::optional<RunInfo> info = ReadRunInfo(file, options.count_commands, error);
    if (!info) {
      errors << "coopdyn: " << error << '\n';
      failed = true;
      continue;
    }
    if (options.json) {
      out << (first ? "" : ",\n ") << ToJson(*info);
    } else {
      out << ToText(*info, options.events);
    }
    failed |= !info->damage.empty() || info->extent.missing > 0;
    first = false;
  }
  if (options.json) out << "]\n";
  return failed ? kExitErrors : kExitOk;
}

void AddInfo(CLI::App& app, Chosen& chosen) {
  auto given = std::make_shared<InfoOptions>();
  CLI::App* sub = app.add_subcommand("info", "Print the contents of recordings; mends one left by a crash");
  sub->footer("Example: coopdyn info lesson1.run --events");
  sub->add_option("run", given->files, "Recordings")->required();
  sub->add_flag("--events", given->events, "List all events, not only notes");
  sub->add_flag("--json", given->json, "One JSON array, an object per recording, with all events");
  sub->add_flag(
      "--count-commands", given->count_commands,
      "Count the commands and look for damage also in a file of more than 256 MiB, which takes a while");
  sub->callback([&chosen, given] {
    chosen = [given] {
      std::ostringstream out, errors;
      const int code = Info(*given, out, errors);
      PrintLines(out.str());
      PrintErrorLines(errors.str());
      return code;
    };
  });
}

}  // namespace coopdyn
