// SPDX-License-Identifier: MIT
// What a file holds in figures, without its scenario.
#include <filesystem>
#include <system_error>

#include "server/record/run_reader_impl.h"

namespace coopdyn {

std::optional<RunContents> RunReader::Contents() {
  impl_->error.clear();
  return impl_->Guard("its tables", [this]() -> std::optional<RunContents> { return impl_->Contents(); });
}

RunContents RunReader::Impl::Contents() {
  RunContents contents;
  for (const char* end : {"", "-wal"}) {
    std::error_code code;
    const std::uintmax_t bytes = std::filesystem::file_size(file + end, code);
    if (!code) contents.bytes += bytes;
  }
  const auto figure = [this](const char* text) {
    return static_cast<std::uint64_t>(database().Integer(text).value_or(0));
  };
  contents.bodies = figure("SELECT count(*) FROM body WHERE scene = (SELECT min(id) FROM scene)");
  contents.scenes = figure("SELECT count(*) FROM scene");
  contents.keyframes = figure("SELECT count(*) FROM keyframe");
  contents.last_hash = figure("SELECT hash FROM step ORDER BY step DESC LIMIT 1");
  contents.inputs = figure("SELECT count(*) FROM input");
  Statement rows = database().Prepare(
      "SELECT name, type FROM robot WHERE scene = (SELECT min(id) FROM scene) ORDER BY place");
  while (rows.Step()) contents.robots.push_back({rows.text(0), rows.text(1)});
  return contents;
}

std::optional<std::uint64_t> RunReader::CountCommands() {
  std::uint64_t commands = 0, rows = 0;
  const bool read = ForEach(impl_->extent.first, impl_->extent.last, true, [&](const RecordedStep& step) {
    ++rows;
    // Those of the first frame are what was in force already.
    if (step.step > impl_->extent.first) commands += step.commands.size();
    return true;
  });
  if (!read) return std::nullopt;
  if (rows <= impl_->extent.steps) {
    impl_->FailSense(std::to_string(rows) + " rows for " + std::to_string(impl_->extent.steps) +
                     " steps and the first frame");
    return std::nullopt;
  }
  return commands;
}

}  // namespace coopdyn
