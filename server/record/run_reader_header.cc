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

bool ReadMeta(Database& database, Meta& meta) {
  Statement rows = database.Prepare("SELECT key, value FROM meta");
  if (!rows) return false;
  for (;;) {
    switch (rows.Step()) {
      case Statement::Result::kRow:
        meta.insert_or_assign(rows.text(0), rows.text(1));
        break;
      case Statement::Result::kDone:
        return true;
      case Statement::Result::kError:
        return false;
    }
  }
}

std::string TextOf(const Meta& meta, const std::string& key) {
  const auto found = meta.find(key);
  return found == meta.end() ? std::string() : found->second;
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

bool ReadTexts(Database& database, RunHeader& header) {
  Statement rows = database.Prepare("SELECT kind, name, file, content FROM text ORDER BY kind, name");
  if (!rows) return false;
  for (;;) {
    switch (rows.Step()) {
      case Statement::Result::kRow:
        if (rows.text(0) == "scenario") {
          header.scenario_text = rows.text(3);
        } else {
          header.sources.push_back({rows.text(0), rows.text(1), rows.text(2), rows.text(3)});
        }
        break;
      case Statement::Result::kDone:
        return true;
      case Statement::Result::kError:
        return false;
    }
  }
}

}  // namespace

bool ReadHeader(Database& database, RunHeader& header, std::string& error) {
  Meta meta;
  if (!ReadMeta(database, meta) || !ReadTexts(database, header)) {
    error = UnfinishedText(database);
    return false;
  }
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
  return true;
}

}  // namespace coopdyn
