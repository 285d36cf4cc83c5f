// SPDX-License-Identifier: MIT
// The tables meta and text: what a recording says about the run as a whole.
#include <charconv>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "server/record/run_reader_open.h"

namespace coopdyn {

namespace {

using Meta = std::unordered_map<std::string, std::string>;

Meta ReadMeta(Database& database) {
  Meta meta;
  Statement rows = database.Prepare("SELECT key, value FROM meta");
  while (rows.Step()) meta.insert_or_assign(rows.text(0), rows.text(1));
  return meta;
}

std::string TextOf(const Meta& meta, const std::string& key) {
  const auto found = meta.find(key);
  return found == meta.end() ? std::string() : found->second;
}

/// Of "diffuse 0123456789abcdef, flock …".
std::vector<PluginHash> PluginsIn(std::string text) {
  std::vector<PluginHash> plugins;
  for (text += ", "; !text.empty();) {
    const std::size_t end = text.find(", "), space = text.rfind(' ', end - 1);
    if (end > 0 && space != std::string::npos) {
      plugins.push_back({text.substr(0, space), text.substr(space + 1, end - space - 1)});
    }
    text.erase(0, end + 2);
  }
  return plugins;
}

/// Nothing if it is missing or no number.
template <typename Number>
std::optional<Number> NumberOf(const Meta& meta, const std::string& key) {
  const std::string text = TextOf(meta, key);
  Number number{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

void ReadTexts(Database& database, RunHeader& header) {
  Statement rows = database.Prepare("SELECT kind, name, file, content FROM text ORDER BY kind, name");
  while (rows.Step()) {
    if (rows.text(0) == "scenario") {
      header.scenario_text = rows.text(3);
    } else {
      header.sources.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(3)});
    }
  }
}

}  // namespace

bool ReadHeader(Database& database, RunHeader& header, std::string& error) {
  const Meta meta = ReadMeta(database);
  ReadTexts(database, header);
  header.version = TextOf(meta, "version");
  header.build = TextOf(meta, "build");
  header.cpu = TextOf(meta, "cpu");
  header.started = TextOf(meta, "started");
  header.command = TextOf(meta, "command");
  header.scenario_name = TextOf(meta, "scenario_name");
  header.scenario_file = TextOf(meta, "scenario_file");
  const auto mode = ParseMode(TextOf(meta, "mode"));
  const auto seed = NumberOf<std::uint64_t>(meta, "seed");
  const auto scenario_seed = NumberOf<std::uint64_t>(meta, "scenario_seed");
  const auto step = NumberOf<Nanoseconds>(meta, "step_ns");
  const auto pose_every = NumberOf<Nanoseconds>(meta, "pose_every_ns");
  std::string unknown;
  const auto what = ParseRecordWhat(TextOf(meta, "what"), unknown);
  const std::string wrong = !mode                                           ? "mode"
                            : !seed                                         ? "seed"
                            : !scenario_seed                                ? "scenario_seed"
                            : !step || *step < kMinStep || *step > kMaxStep ? "step_ns"
                            : !pose_every || *pose_every < 0                ? "pose_every_ns"
                            : !what                                         ? "what"
                                                                            : "";
  if (!wrong.empty()) {
    error = database.file() + " is damaged: its table meta says '" + TextOf(meta, wrong) + "' for " + wrong +
            ": copy it again from where it was recorded";
    return false;
  }
  header.mode = *mode;
  header.seed = *seed;
  header.scenario_seed = *scenario_seed;
  header.step_length = *step;
  header.substeps = NumberOf<int>(meta, "substeps");
  header.what = *what;
  header.pose_every = *pose_every;
  header.controllers = PluginsIn(TextOf(meta, "controllers"));
  return true;
}

}  // namespace coopdyn
