// SPDX-License-Identifier: MIT
// Opening, and finding the way in a file. What a step holds is read in run_reader_steps.cc.
#include "server/record/run_reader.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "server/record/run_reader_impl.h"

namespace coopdyn {

namespace {

constexpr int kLooksBeforeDoubt = 10;

/// Step numbers fit SQLite's integers; what does not is beyond the last step of any file.
std::int64_t Key(std::uint64_t number) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
  return static_cast<std::int64_t>(std::min(number, kMost));
}

}  // namespace

bool RunReader::Impl::FailAsReplaced() {
  struct stat there {};
  if (::stat(file.c_str(), &there) != 0) return false;
  if (inode == 0) inode = there.st_ino;
  if (there.st_ino == inode) return false;
  error = file + " was replaced by another file while it was read: open it again";
  return true;
}

bool RunReader::Impl::FailReading(const std::string& what) {
  if (FailAsReplaced()) return false;
  const bool busy = run.database != nullptr && database().busy();
  const std::string why = run.database != nullptr ? database().error() : file;
  error = why + ", at " + what +
          (busy ? ": another program holds it, try again"
                : ": the file is damaged there, copy it again from where it was recorded; other times of it "
                  "may still be read");
  return false;
}

bool RunReader::Impl::FailSense(const std::string& what) {
  if (FailAsReplaced()) return false;
  error =
      file + ": " + what +
      " cannot be: the file is damaged there, copy it again from where it was recorded; other times of it "
      "may still be read";
  return false;
}

bool RunReader::Impl::Open() {
  if (FailAsReplaced()) return false;
  const bool was_mended = run.mended;
  sql.reset();
  run = {};
  OpenedRun opened = OpenRun(file, error);
  if (opened.database == nullptr) return false;
  run = std::move(opened);
  run.mended |= was_mended;
  unchanged = 0;
  return Prepare();
}

bool RunReader::Impl::Prepare() {
  sql.emplace();
  const std::pair<Statement&, const char*> all[] = {
      {sql->first, "SELECT step, time_ns FROM step ORDER BY step LIMIT 1"},
      {sql->last, "SELECT step, time_ns FROM step ORDER BY step DESC LIMIT 1"},
      {sql->at_or_after, "SELECT step, time_ns FROM step WHERE step >= ?1 ORDER BY step LIMIT 1"},
      // length() looks at the row's head alone, where IS NULL would read the poses.
      {sql->shown_before,
       "SELECT step FROM step WHERE step < ?1 AND length(poses) > 0 ORDER BY step DESC LIMIT 1"},
      {sql->shown_after, "SELECT step FROM step WHERE step > ?1 AND length(poses) > 0 ORDER BY step LIMIT 1"},
      {sql->inputs, "SELECT step, time_ns, hash, scene, commands, messages FROM step WHERE step = ?1"},
      {sql->whole,
       "SELECT step, time_ns, hash, scene, commands, messages, wheels, distances, targets, poses FROM step"
       " WHERE step = ?1"},
      {sql->keyframe, "SELECT step, state FROM keyframe WHERE step <= ?1 ORDER BY step DESC LIMIT 1"},
      {sql->scene, "SELECT description FROM scene WHERE id = ?1"},
      {sql->meta, "SELECT value FROM meta WHERE key = ?1"},
  };
  for (const auto& [statement, text] : all) {
    statement = database().Prepare(text);
    if (statement) continue;
    error = UnfinishedText(database());
    sql.reset();
    return false;
  }
  return true;
}

bool RunReader::Impl::Refresh() {
  error.clear();
  if (!sql) return FailReading("its start");
  const bool closed = run.growing && IsClosed(database());
  RunExtent found;
  for (Statement* end : {&sql->first, &sql->last}) {
    end->Reset();
    const Result result = end->Step();
    if (result == Result::kError) return FailReading("its ends");
    if (result == Result::kDone) {
      error = file + " holds no steps" +
              (run.growing ? " yet: try again in a second" : ": nothing was recorded before it ended");
      return false;
    }
    const bool sane = end->integer(0) >= 0 && end->integer(1) >= 0;
    (end == &sql->first ? found.first : found.last) = static_cast<std::uint64_t>(end->integer(0));
    (end == &sql->first ? found.begin : found.end) = end->integer(1);
    end->Reset();
    if (!sane) return FailSense("a step number or time below 0");
  }
  if (found.end < found.begin) return FailSense("a run that ends before it begins");
  sql->meta.Reset();
  sql->meta.BindText(1, "lost");
  const bool has_lost = sql->meta.Step() == Result::kRow;
  const std::uint64_t span = found.last - found.first;
  if (has_lost) {
    found.lost = static_cast<std::uint64_t>(
        std::clamp<std::int64_t>(sql->meta.integer(0), 0, static_cast<std::int64_t>(span)));
  }
  sql->meta.Reset();
  sql->meta.BindText(1, "last_step");
  if (sql->meta.Step() == Result::kRow) {
    const std::int64_t last = sql->meta.integer(0);
    if (last > static_cast<std::int64_t>(found.last))
      found.missing = static_cast<std::uint64_t>(last) - found.last;
  }
  sql->meta.Reset();
  found.steps = span - found.lost;
  unchanged = found.last == extent.last ? unchanged + 1 : 0;
  extent = found;
  if (!run.growing || (!closed && unchanged < kLooksBeforeDoubt)) return true;
  // Closed, or its writer may be gone: opened anew it tells, and is mended in that case.
  return Open() && (run.growing || Refresh());
}

std::optional<std::uint64_t> RunReader::Impl::One(Statement& statement, std::uint64_t key, const char* what) {
  statement.Reset();
  statement.Bind(1, Key(key));
  const Result result = statement.Step();
  if (result != Result::kRow) {
    result == Result::kError ? FailReading(std::string(what) + " " + std::to_string(key)) : FailAsReplaced();
    return std::nullopt;
  }
  const std::int64_t found = statement.integer(0);
  statement.Reset();
  if (found < 0) {
    FailSense("a step number below 0");
    return std::nullopt;
  }
  return static_cast<std::uint64_t>(found);
}

RunReader::RunReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

RunReader::~RunReader() = default;

std::unique_ptr<RunReader> RunReader::Open(const std::string& file, std::string& error) {
  auto impl = std::make_unique<Impl>();
  impl->file = file;
  std::error_code missing;
  if (!std::filesystem::exists(file, missing) && std::filesystem::exists(file + ".run", missing)) {
    impl->file = file + ".run";  // recordings are started and fetched by their bare names
  }
  const bool fine =
      impl->Open() && ReadHeader(impl->database(), impl->header, impl->error) && impl->Refresh();
  if (!fine) {
    error = impl->error;
    return nullptr;
  }
  error.clear();
  return std::unique_ptr<RunReader>(new RunReader(std::move(impl)));
}

const std::string& RunReader::file() const {
  return impl_->file;
}

const RunHeader& RunReader::header() const {
  return impl_->header;
}

bool RunReader::mended() const {
  return impl_->run.mended;
}

bool RunReader::growing() const {
  return impl_->run.growing;
}

bool RunReader::has_log() const {
  return !UnmergedLog(impl_->file).empty();
}

const std::string& RunReader::log_reason() const {
  return impl_->run.log_reason;
}

const std::string& RunReader::error() const {
  return impl_->error;
}

RunExtent RunReader::extent() {
  if (impl_->run.growing) impl_->Refresh();
  return impl_->extent;
}

std::optional<std::uint64_t> RunReader::StepAt(Nanoseconds time, bool with_poses) {
  Impl& impl = *impl_;
  impl.error.clear();
  if (!impl.sql) return impl.FailReading("its start"), std::nullopt;
  // Time grows with the step. `low` is a step at or before `time`; those from `high` on come after it.
  std::uint64_t low = impl.extent.first;
  std::uint64_t high = time >= impl.extent.end ? low : impl.extent.last;
  if (time >= impl.extent.end) low = impl.extent.last;
  Statement& probe = impl.sql->at_or_after;
  while (high > low && high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    probe.Bind(1, Key(middle));
    const Impl::Result result = probe.Step();
    if (result == Impl::Result::kError) {
      return impl.FailReading("step " + std::to_string(middle)), std::nullopt;
    }
    const bool found = result == Impl::Result::kRow;
    const auto step = found ? static_cast<std::uint64_t>(probe.integer(0)) : high;
    const bool before = step < high && probe.integer(1) <= time;
    probe.Reset();
    (before ? low : high) = before ? step : middle;
  }
  if (!with_poses) return low;
  if (const auto shown = impl.One(impl.sql->shown_before, low + 1, "step")) return shown;
  if (!impl.error.empty()) return std::nullopt;
  const auto shown = impl.One(impl.sql->shown_after, low, "step");
  if (!shown && impl.error.empty()) {
    impl.error = impl.file + ": no poses were recorded in it: record it again with a smaller --record-every";
  }
  return shown;
}

std::optional<std::uint64_t> RunReader::NextShown(std::uint64_t step, bool back) {
  impl_->error.clear();
  if (!impl_->sql) return impl_->FailReading("its start"), std::nullopt;
  return impl_->One(back ? impl_->sql->shown_before : impl_->sql->shown_after, step, "step");
}

std::vector<std::uint64_t> RunReader::Keyframes() {
  Impl& impl = *impl_;
  impl.error.clear();
  std::vector<std::uint64_t> steps;
  if (!impl.sql) return impl.FailReading("its keyframes"), steps;
  Statement rows = impl.database().Prepare("SELECT step FROM keyframe WHERE step >= 0 ORDER BY step");
  Impl::Result result = rows ? rows.Step() : Impl::Result::kError;
  for (; result == Impl::Result::kRow; result = rows.Step()) {
    steps.push_back(static_cast<std::uint64_t>(rows.integer(0)));
  }
  if (result == Impl::Result::kError) impl.FailReading("its keyframes");
  return steps;
}

std::vector<RunInput> RunReader::Inputs(std::uint64_t first, std::uint64_t last) {
  Impl& impl = *impl_;
  impl.error.clear();
  if (!impl.sql) return impl.FailReading("its inputs"), std::vector<RunInput>();
  // They are few, and asked for range by range: read once, and what has come since.
  Statement rows =
      impl.database().Prepare("SELECT id, step, action, detail FROM input WHERE id > ?1 ORDER BY id");
  if (rows) rows.Bind(1, impl.newest_input);
  Impl::Result result = rows ? rows.Step() : Impl::Result::kError;
  for (; result == Impl::Result::kRow; result = rows.Step()) {
    impl.newest_input = rows.integer(0);
    impl.run_inputs.push_back({static_cast<std::uint64_t>(rows.integer(1)), rows.text(2), rows.text(3)});
  }
  if (result == Impl::Result::kError) impl.FailReading("its inputs");
  std::vector<RunInput> inputs;
  std::copy_if(impl.run_inputs.begin(), impl.run_inputs.end(), std::back_inserter(inputs),
               [&](const RunInput& input) { return input.step >= first && input.step <= last; });
  return inputs;
}

std::vector<Event> RunReader::Events() {
  Impl& impl = *impl_;
  impl.error.clear();
  std::vector<Event> events;
  if (!impl.sql) return impl.FailReading("its events"), events;
  Statement rows = impl.database().Prepare("SELECT step, time_ns, level, text FROM event ORDER BY id");
  Impl::Result result = rows ? rows.Step() : Impl::Result::kError;
  for (; result == Impl::Result::kRow; result = rows.Step()) {
    events.push_back({static_cast<std::uint64_t>(rows.integer(0)), ToSeconds(rows.integer(1)), rows.text(2),
                      rows.text(3)});
  }
  if (result == Impl::Result::kError) impl.FailReading("its events");
  return events;
}

}  // namespace coopdyn
