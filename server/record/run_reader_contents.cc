// SPDX-License-Identifier: MIT
// What a file holds in figures, without its scenario.
#include <filesystem>
#include <system_error>

#include "server/record/run_reader_impl.h"

namespace coopdyn {

std::optional<RunContents> RunReader::Contents() {
  Impl& impl = *impl_;
  impl.error.clear();
  if (!impl.sql) return impl.FailReading("its start"), std::nullopt;
  RunContents contents;
  for (const char* end : {"", "-wal"}) {
    std::error_code code;
    const std::uintmax_t bytes = std::filesystem::file_size(impl.file + end, code);
    if (!code) contents.bytes += bytes;
  }
  struct Figure {
    const char* what;
    const char* sql;
    std::uint64_t& value;
  };
  const Figure figures[] = {
      {"its bodies", "SELECT count(*) FROM body WHERE scene = (SELECT min(id) FROM scene)", contents.bodies},
      {"its scenes", "SELECT count(*) FROM scene", contents.scenes},
      {"its keyframes", "SELECT count(*) FROM keyframe", contents.keyframes},
      {"its last step", "SELECT hash FROM step ORDER BY step DESC LIMIT 1", contents.last_hash},
      {"its inputs", "SELECT count(*) FROM input", contents.inputs},
  };
  for (const Figure& figure : figures) {
    const std::optional<std::int64_t> value = impl.database().Integer(figure.sql);
    if (!value) return impl.FailReading(figure.what), std::nullopt;
    figure.value = static_cast<std::uint64_t>(*value);
  }
  Statement rows = impl.database().Prepare(
      "SELECT name, type FROM robot WHERE scene = (SELECT min(id) FROM scene) ORDER BY place");
  Impl::Result result = rows ? rows.Step() : Impl::Result::kError;
  for (; result == Impl::Result::kRow; result = rows.Step()) {
    contents.robots.push_back({rows.text(0), rows.text(1)});
  }
  if (result == Impl::Result::kError) return impl.FailReading("its robots"), std::nullopt;
  return contents;
}

std::optional<std::uint64_t> RunReader::CountCommands() {
  std::uint64_t commands = 0;
  const bool read = ForEach(impl_->extent.first, impl_->extent.last, true, [&](const RecordedStep& step) {
    // Those of the first frame are what was in force already.
    if (step.step > impl_->extent.first) commands += step.commands.size();
    return true;
  });
  if (!read) return std::nullopt;
  return commands;
}

}  // namespace coopdyn
