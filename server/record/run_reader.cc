// SPDX-License-Identifier: MIT
// Opening, and finding the way in a file. What a step holds is read in run_reader_steps.cc.
#include "server/record/run_reader.h"

#include <spdlog/fmt/fmt.h>
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

bool RunReader::Impl::FailReading(const DatabaseError& failed, const std::string& what) {
  if (FailAsReplaced()) return false;
  error = std::string(failed.what()) + ", at " + what +
          (failed.busy() ? ": another program holds it, try again"
                         : ": the file is damaged there, copy it again from where it was recorded; other "
                           "times of it may still be read");
  return false;
}

bool RunReader::Impl::FailSense(const std::string& what) {
  if (FailAsReplaced()) return false;
  error = file + " is damaged (" + what +
          "): copy it again from where it was recorded; other times of it may still be read";
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
      {sql->first_keyframe, "SELECT step FROM keyframe ORDER BY step LIMIT 1"},
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
    error = UnfinishedText(database().error());
    sql.reset();
    return false;
  }
  return true;
}

bool RunReader::Impl::Refresh() {
  error.clear();
  const bool closed = run.growing && Guard("its table meta", [this] { return IsClosed(database()); });
  if (!error.empty() || !Guard("its ends", [this] { return Look(); })) return false;
  if (!run.growing || (!closed && unchanged < kLooksBeforeDoubt)) return true;
  // Closed, or its writer may be gone: opened anew it tells, and is mended in that case.
  return Open() && (run.growing || Refresh());
}

bool RunReader::Impl::Look() {
  RunExtent found;
  for (Statement* end : {&sql->first, &sql->last}) {
    end->Reset();
    if (!end->Step()) {
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
  if (found.end < found.begin || found.last < found.first)
    return FailSense("a run that ends before it begins");
  sql->first_keyframe.Reset();
  const bool hides_first =
      sql->first_keyframe.Step() && sql->first_keyframe.integer(0) < static_cast<std::int64_t>(found.first);
  sql->first_keyframe.Reset();
  if (hides_first) return FailSense("step " + std::to_string(found.first) + " as the first");
  const std::uint64_t span = found.last - found.first;
  const std::int64_t lost = std::max<std::int64_t>(Meta("lost"), 0);
  const std::int64_t after = std::clamp<std::int64_t>(Meta("lost_after"), 0, lost);
  found.lost = std::min(span, static_cast<std::uint64_t>(lost - after));
  found.lost_after = static_cast<std::uint64_t>(after);
  const std::int64_t last = Meta("last_step");
  if (last > static_cast<std::int64_t>(found.last)) {
    found.missing = static_cast<std::uint64_t>(last) - found.last;
  }
  found.steps = span - found.lost;
  unchanged = found.last == extent.last ? unchanged + 1 : 0;
  extent = found;
  return true;
}

std::optional<std::uint64_t> RunReader::Impl::One(Statement& statement, std::uint64_t key) {
  statement.Reset();
  statement.Bind(1, Key(key));
  if (!statement.Step()) {
    FailAsReplaced();
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
  const auto read_header = [&impl] { return ReadHeader(impl->database(), impl->header, impl->error); };
  if (!impl->Open() || !impl->Guard("its table meta", read_header) || !impl->Refresh()) {
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
  impl_->error.clear();
  return impl_->Guard(fmt::format("the step of {:g} s", ToSeconds(time)),
                      [&] { return impl_->StepAt(time, with_poses); });
}

std::optional<std::uint64_t> RunReader::Impl::StepAt(Nanoseconds time, bool with_poses) {
  // Time grows with the step. `low` is a step at or before `time`; those from `high` on come after it.
  std::uint64_t low = extent.first;
  std::uint64_t high = time >= extent.end ? low : extent.last;
  if (time >= extent.end) low = extent.last;
  Statement& probe = sql->at_or_after;
  while (high > low && high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    probe.Bind(1, Key(middle));
    const bool found = probe.Step();
    const auto step = found ? static_cast<std::uint64_t>(probe.integer(0)) : high;
    const bool before = step < high && probe.integer(1) <= time;
    probe.Reset();
    (before ? low : high) = before ? step : middle;
  }
  if (!with_poses) return low;
  if (const auto shown = One(sql->shown_before, low + 1)) return shown;
  if (!error.empty()) return std::nullopt;
  const auto shown = One(sql->shown_after, low);
  if (!shown && error.empty()) {
    error = file + ": no poses were recorded in it: record it again with a smaller --record-every";
  }
  return shown;
}

std::optional<std::uint64_t> RunReader::NextShown(std::uint64_t step, bool back) {
  impl_->error.clear();
  const std::string what = (back ? "the step before " : "the step after ") + std::to_string(step);
  return impl_->Guard(what, [&] { return impl_->NextShown(step, back); });
}

std::int64_t RunReader::Impl::Meta(const char* key) {
  sql->meta.Reset();
  sql->meta.BindText(1, key);
  const std::int64_t value = sql->meta.Step() ? sql->meta.integer(0) : 0;
  sql->meta.Reset();
  return value;
}

std::optional<std::uint64_t> RunReader::Impl::NextShown(std::uint64_t step, bool back) {
  const auto shown = One(back ? sql->shown_before : sql->shown_after, step);
  if (!shown || back || *shown == step + 1) return shown;
  // What was lost ends with a keyframe; the others, without poses, are there.
  const auto next = One(sql->at_or_after, step + 1);
  if (!next || *next == step + 1) return next ? shown : std::nullopt;
  const auto keyframe = One(sql->keyframe, *next);
  const auto left_out = static_cast<std::int64_t>(*next - step - 1);
  if (keyframe == next && left_out <= Meta("lost")) return shown;
  FailSense("a gap from step " + std::to_string(step) + " to " + std::to_string(*next));
  return std::nullopt;
}

std::vector<std::uint64_t> RunReader::Keyframes() {
  impl_->error.clear();
  return impl_->Guard("its keyframes", [this] {
    std::vector<std::uint64_t> steps;
    Statement rows = impl_->database().Prepare("SELECT step FROM keyframe WHERE step >= 0 ORDER BY step");
    while (rows.Step()) steps.push_back(static_cast<std::uint64_t>(rows.integer(0)));
    return steps;
  });
}

std::vector<RunInput> RunReader::Inputs(std::uint64_t first, std::uint64_t last) {
  impl_->error.clear();
  return impl_->Guard("its inputs", [&] {
    Impl& impl = *impl_;
    // They are few, and asked for range by range: read once, and what has come since.
    Statement rows =
        impl.database().Prepare("SELECT id, step, action, detail FROM input WHERE id > ?1 ORDER BY id");
    rows.Bind(1, impl.newest_input);
    while (rows.Step()) {
      const std::string action = rows.text(2), detail = rows.text(3);
      auto input = DecodeInput(static_cast<std::uint64_t>(rows.integer(1)), action, detail);
      if (!input) {
        impl.FailSense("the input \"" + action + " " + detail + "\"");
        return std::vector<RunInput>();
      }
      impl.newest_input = rows.integer(0);
      impl.run_inputs.push_back(*std::move(input));
    }
    std::vector<RunInput> inputs;
    std::copy_if(impl.run_inputs.begin(), impl.run_inputs.end(), std::back_inserter(inputs),
                 [&](const RunInput& input) { return input.step >= first && input.step <= last; });
    return inputs;
  });
}

std::vector<Event> RunReader::Events() {
  impl_->error.clear();
  return impl_->Guard("its events", [this] {
    std::vector<Event> events;
    Statement rows = impl_->database().Prepare("SELECT step, time_ns, level, text FROM event ORDER BY id");
    while (rows.Step()) {
      events.push_back({static_cast<std::uint64_t>(rows.integer(0)), ToSeconds(rows.integer(1)), rows.text(2),
                        rows.text(3)});
    }
    return events;
  });
}

}  // namespace coopdyn
