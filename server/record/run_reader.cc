// SPDX-License-Identifier: MIT
#include "server/record/run_reader.h"

#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>
#include <set>
#include <system_error>
#include <utility>

#include "server/record/run_tables.h"
#include "server/record/state_codec.h"
#include "server/record/step_row.h"

namespace coopdyn {

namespace {

constexpr int kLooksBeforeDoubt = 10;
/// Steps per read transaction: a writer waits for readers before it can truncate its log.
constexpr std::int64_t kStepsInMemory = 500;
constexpr std::uint64_t kMostStep = std::numeric_limits<std::int64_t>::max();

// length() reads only the head of a row, whereas IS NULL would read the poses.
constexpr const char* kShownBefore =
    "SELECT step FROM step WHERE step < ?1 AND length(poses) > 0 ORDER BY step DESC LIMIT 1";
constexpr const char* kShownAfter =
    "SELECT step FROM step WHERE step > ?1 AND length(poses) > 0 ORDER BY step LIMIT 1";

}  // namespace

template <typename Get>
auto RunReader::Guard(const std::string& what, Get get) -> decltype(get()) {
  error_.clear();
  try {
    return get();
  } catch (const Failure& failure) {
    error_ = failure.text;
  } catch (const DatabaseError& failed) {
    error_ = std::string(failed.what()) + ", at " + what +
             (failed.busy() ? ": another program holds it, try again"
                            : ": the file is damaged there, copy it again from where it was recorded; other "
                              "times of it may still be read");
    if (IsReplaced()) error_ = file_ + " was replaced by another file while it was read: open it again";
  }
  return {};
}

const Database& RunReader::database() const {
  if (run_.database == nullptr) throw DatabaseError(file_);
  return *run_.database;
}

bool RunReader::IsReplaced() const {
  struct stat there {};
  return ::stat(file_.c_str(), &there) == 0 && there.st_ino != inode_;
}

void RunReader::CheckNotReplaced() const {
  if (IsReplaced()) throw DatabaseError(file_);
}

void RunReader::Damaged(const std::string& what) const {
  CheckNotReplaced();
  throw Failure{file_ + " is damaged (" + what +
                "): copy it again from where it was recorded; other times of it may still be read"};
}

// --- opening

std::unique_ptr<RunReader> RunReader::Open(const std::string& file, std::string& error) {
  std::string name = file;
  std::error_code missing;
  // Users may omit the ".run".
  if (!std::filesystem::exists(name, missing) && std::filesystem::exists(name + ".run", missing)) {
    name += ".run";
  }
  std::unique_ptr<RunReader> reader(new RunReader(name));
  const bool opened = reader->Guard("its table meta", [&reader] {
    struct stat there {};
    if (::stat(reader->file_.c_str(), &there) == 0) reader->inode_ = there.st_ino;
    reader->Reopen();
    if (std::string wrong = ReadHeader(reader->database(), reader->header_); !wrong.empty()) {
      throw Failure{std::move(wrong)};
    }
    reader->Refresh();
    return true;
  });
  error = reader->error_;
  return opened ? std::move(reader) : nullptr;
}

void RunReader::Reopen() {
  CheckNotReplaced();
  const bool was_mended = run_.mended;
  run_ = {};
  std::string error;
  run_ = OpenRun(file_, error);
  if (run_.database == nullptr) throw Failure{error};
  run_.mended |= was_mended;
  unchanged_ = 0;
  try {  // check that all needed columns exist
    has_scores_ = StepColumns::HasScores(database());
    database().Prepare(StepColumns::Select(false, has_scores_));
    for (const char* sql :
         {"SELECT step, state FROM keyframe", "SELECT description FROM scene", "SELECT value FROM meta"}) {
      database().Prepare(sql);
    }
  } catch (const DatabaseError& failed) {
    throw Failure{UnfinishedText(failed.what())};
  }
}

void RunReader::Refresh() {
  const bool closed = run_.growing && IsClosed(database());
  const RunExtent found = Look();
  unchanged_ = found.last == extent_.last ? unchanged_ + 1 : 0;
  extent_ = found;
  if (!run_.growing || (!closed && unchanged_ < kLooksBeforeDoubt)) return;
  // The recording is closed, or its writer may have died: opening the file again tells, and mends it.
  Reopen();
  if (!run_.growing) Refresh();
}

RunExtent RunReader::Look() const {
  RunExtent found;
  for (const bool last : {false, true}) {
    Statement end = database().Prepare(std::string("SELECT step, time_ns FROM step ORDER BY step ") +
                                       (last ? "DESC LIMIT 1" : "LIMIT 1"));
    if (!end.Step()) {
      throw Failure{
          file_ + " holds no steps" +
          (run_.growing ? " yet: try again in a second" : ": nothing was recorded before it ended")};
    }
    if (end.integer(0) < 0 || end.integer(1) < 0) Damaged("a step number or time below 0");
    (last ? found.last : found.first) = static_cast<std::uint64_t>(end.integer(0));
    (last ? found.end : found.begin) = end.integer(1);
  }
  if (found.end < found.begin || found.last < found.first) Damaged("a run that ends before it begins");
  const auto keyframe = database().Integer("SELECT step FROM keyframe ORDER BY step LIMIT 1");
  if (keyframe && *keyframe < static_cast<std::int64_t>(found.first))
    Damaged("step " + std::to_string(found.first) + " as the first");
  const std::uint64_t span = found.last - found.first;
  const std::int64_t lost = std::max<std::int64_t>(Meta("lost"), 0);
  const std::int64_t after = std::clamp<std::int64_t>(Meta("lost_after"), 0, lost);
  found.lost = std::min(span, static_cast<std::uint64_t>(lost - after));
  found.lost_after = static_cast<std::uint64_t>(after);
  const std::int64_t last = Meta("last_step");
  if (last > static_cast<std::int64_t>(found.last))
    found.missing = static_cast<std::uint64_t>(last) - found.last;
  found.steps = span - found.lost;
  return found;
}

RunExtent RunReader::extent() {
  if (run_.growing) {
    Guard("its ends", [this] {
      Refresh();
      return true;
    });
  }
  return extent_;
}

std::int64_t RunReader::Meta(const char* key) const {
  return database().Integer("SELECT value FROM meta WHERE key = ?", key).value_or(0);
}

std::shared_ptr<const Scenario> RunReader::LoadScenario(const SearchPath& path, Diagnostics& diagnostics) {
  library_ = std::make_unique<RobotLibrary>(path, header_.sources);
  scenes_.clear();
  scenario_ = ReadScenario(header_.scenario_text, header_.scenario_file, *library_,
                           header_.scenario_file.empty(), diagnostics, header_.scenario_seed);
  return scenario_;
}

void RunReader::UseScenario(std::shared_ptr<const Scenario> scenario) {
  library_ = std::make_unique<RobotLibrary>(SearchPath(), header_.sources);
  scenes_.clear();
  scenario_ = std::move(scenario);
}

// --- the file as a whole

std::optional<RunContents> RunReader::Contents() {
  return Guard("its tables", [this] {
    std::optional<RunContents> contents(std::in_place);
    for (const char* end : {"", "-wal"}) {
      std::error_code code;
      const std::uintmax_t bytes = std::filesystem::file_size(file_ + end, code);
      if (!code) contents->bytes += bytes;
    }
    const auto figure = [this](const char* sql) {
      return static_cast<std::uint64_t>(database().Integer(sql).value_or(0));
    };
    contents->bodies = figure("SELECT count(*) FROM body WHERE scene = (SELECT min(id) FROM scene)");
    contents->scenes = figure("SELECT count(*) FROM scene");
    contents->keyframes = figure("SELECT count(*) FROM keyframe");
    contents->last_hash = figure("SELECT hash FROM step ORDER BY step DESC LIMIT 1");
    contents->inputs = figure("SELECT count(*) FROM input");
    Statement rows = database().Prepare(
        "SELECT name, type FROM robot WHERE scene = (SELECT min(id) FROM scene) ORDER BY place");
    while (rows.Step()) contents->robots.push_back({rows.text(0), rows.text(1)});
    return contents;
  });
}

std::optional<std::uint64_t> RunReader::CountCommands() {
  std::uint64_t commands = 0, rows = 0;
  std::set<std::pair<std::int64_t, std::int64_t>> begins;  // scene and first channel of each actuator
  const bool known = Guard("its channels", [&] {
    Statement firsts =
        database().Prepare("SELECT scene, min(place) FROM channel GROUP BY scene, robot, module");
    while (firsts.Step()) begins.emplace(firsts.integer(0), firsts.integer(1));
    return true;
  });
  const bool read =
      known && ForEach(extent_.first, extent_.last, true, [&](const RecordedStep& step) {
        ++rows;
        // Commands of the first frame were already in force.
        if (step.step == extent_.first) return true;
        for (const CommandRecord& command : step.commands) {
          commands += begins.contains({static_cast<std::int64_t>(step.scene), command.channel}) ? 1 : 0;
        }
        return true;
      });
  if (!read) return std::nullopt;
  return Guard("its steps", [&] {
    if (rows <= extent_.steps) {
      Damaged(fmt::format("{} rows for {} steps and the first frame", rows, extent_.steps));
    }
    return std::optional(commands);
  });
}

std::vector<Event> RunReader::Events() {
  std::int64_t id = 0;
  return EventsAfter(id);
}

std::vector<Event> RunReader::EventsAfter(std::int64_t& id) {
  return Guard("its events", [this, &id] {
    std::vector<Event> events;
    Statement rows =
        database().Prepare("SELECT step, time_ns, level, text, id FROM event WHERE id > ?1 ORDER BY id");
    rows.Bind(1, id);
    while (rows.Step()) {
      id = rows.integer(4);
      events.push_back({static_cast<std::uint64_t>(rows.integer(0)), ToSeconds(rows.integer(1)), rows.text(2),
                        rows.text(3)});
    }
    return events;
  });
}

std::vector<RunInput> RunReader::Inputs(std::uint64_t first, std::uint64_t last) {
  return Guard("its inputs", [&] {
    // Inputs are few and requested range by range: cache them and read only new rows.
    Statement rows =
        database().Prepare("SELECT id, step, action, detail FROM input WHERE id > ?1 ORDER BY id");
    rows.Bind(1, newest_input_);
    while (rows.Step()) {
      const std::string action = rows.text(2), detail = rows.text(3);
      const auto step = static_cast<std::uint64_t>(rows.integer(1));
      const FindModel model = library_ != nullptr ? ModelFinder() : nullptr;
      const FindTexture texture = library_ != nullptr ? TextureFinder() : nullptr;
      const SceneContext context{scenario_.get(), &model, &texture};
      auto input = DecodeInput(step, action, detail, context);
      if (!input && library_ != nullptr) {
        ReadTextsAgain();
        input = DecodeInput(step, action, detail, context);
      }
      if (!input) Damaged("the input \"" + action + " " + detail + "\"");
      newest_input_ = rows.integer(0);
      inputs_.push_back(*std::move(input));
    }
    std::vector<RunInput> inputs;
    std::copy_if(inputs_.begin(), inputs_.end(), std::back_inserter(inputs),
                 [&](const RunInput& input) { return input.step >= first && input.step <= last; });
    return inputs;
  });
}

// --- finding steps

std::optional<std::uint64_t> RunReader::FindStep(const char* sql, std::uint64_t step) const {
  const std::optional<std::int64_t> found = database().Integer(sql, step);
  if (!found) return CheckNotReplaced(), std::nullopt;
  if (*found < 0) Damaged("a step number below 0");
  return static_cast<std::uint64_t>(*found);
}

std::optional<std::uint64_t> RunReader::StepAt(Nanoseconds time, bool with_poses) {
  return Guard(fmt::format("the step of {:g} s", ToSeconds(time)), [&] {
    // Time grows with the step. `low` is a step at or before `time`; those from `high` on come after it.
    std::uint64_t low = time >= extent_.end ? extent_.last : extent_.first;
    std::uint64_t high = time >= extent_.end ? extent_.first : extent_.last;
    Statement probe =
        database().Prepare("SELECT step, time_ns FROM step WHERE step >= ?1 ORDER BY step LIMIT 1");
    while (high > low && high - low > 1) {
      const std::uint64_t middle = low + (high - low) / 2;
      probe.Bind(1, middle);
      const std::uint64_t step = probe.Step() ? static_cast<std::uint64_t>(probe.integer(0)) : high;
      const bool before = step < high && probe.integer(1) <= time;
      probe.Reset();
      (before ? low : high) = before ? step : middle;
    }
    if (!with_poses) return std::optional(low);
    std::optional<std::uint64_t> shown = FindStep(kShownBefore, low + 1);
    if (!shown) shown = FindStep(kShownAfter, low);
    if (shown) return shown;
    throw Failure{file_ + ": no poses were recorded in it: record it again with a smaller --record-every"};
  });
}

std::optional<std::uint64_t> RunReader::NextShown(std::uint64_t step, bool back) {
  const std::string what = (back ? "the step before " : "the step after ") + std::to_string(step);
  return Guard(what, [&] {
    const auto shown = FindStep(back ? kShownBefore : kShownAfter, step);
    if (!shown || back || *shown == step + 1) return shown;
    // A keyframe follows lost steps; steps without poses still have rows.
    const auto next =
        FindStep("SELECT step FROM step WHERE step >= ?1 ORDER BY step LIMIT 1", step + 1).value_or(*shown);
    if (next == step + 1) return shown;
    const auto keyframe =
        FindStep("SELECT step FROM keyframe WHERE step <= ?1 ORDER BY step DESC LIMIT 1", next);
    if (keyframe != next || Meta("lost") < static_cast<std::int64_t>(next - step - 1)) {
      Damaged("a gap from step " + std::to_string(step) + " to " + std::to_string(next));
    }
    return shown;
  });
}

std::vector<std::uint64_t> RunReader::Keyframes() {
  return Guard("its keyframes", [this] {
    std::vector<std::uint64_t> steps;
    Statement rows = database().Prepare("SELECT step FROM keyframe WHERE step >= 0 ORDER BY step");
    while (rows.Step()) steps.push_back(static_cast<std::uint64_t>(rows.integer(0)));
    return steps;
  });
}

// --- the contents of a step

RecordedStep RunReader::Decode(const Statement& row, bool inputs_only) {
  RecordedStep step;
  std::string damage = DecodeHead(row, step);
  if (damage.empty()) {
    const bool needs_scene = !inputs_only || scenario_ != nullptr;
    const std::shared_ptr<const Scene> scene = needs_scene ? FindScene(step.scene) : nullptr;
    damage = DecodeInputs(row, scene.get(), step);
    if (damage.empty() && !inputs_only) damage = DecodeReadings(row, *scene, step);
  }
  if (!damage.empty()) Damaged(damage + " of step " + std::to_string(row.integer(StepColumns::kStep)));
  return step;
}

std::optional<RecordedStep> RunReader::Read(std::uint64_t step, bool inputs_only) {
  return Guard("step " + std::to_string(step), [&]() -> std::optional<RecordedStep> {
    Statement row = database().Prepare(StepColumns::Select(inputs_only, has_scores_) + " WHERE step = ?1");
    row.Bind(1, step);
    if (row.Step()) return Decode(row, inputs_only);
    CheckNotReplaced();
    return std::nullopt;
  });
}

bool RunReader::ForEach(std::uint64_t first, std::uint64_t last, bool inputs_only,
                        const std::function<bool(const RecordedStep&)>& use) {
  return Guard("the steps from " + std::to_string(first) + " on", [&] {
    Statement rows = database().Prepare(StepColumns::Select(inputs_only, has_scores_) +
                                        " WHERE step > ?1 AND step <= ?2 ORDER BY step LIMIT ?3");
    std::int64_t before = static_cast<std::int64_t>(std::min(first, kMostStep)) - 1;
    for (std::int64_t count = kStepsInMemory; count == kStepsInMemory;) {
      rows.BindAll(before, last, kStepsInMemory);
      for (count = 0; rows.Step(); ++count) {
        const RecordedStep step = Decode(rows, inputs_only);
        // In a damaged file rows may be in any order.
        if (rows.integer(StepColumns::kStep) <= before)
          Damaged("step " + std::to_string(step.step) + " at its place");
        if (!use(step)) return true;
        before = rows.integer(StepColumns::kStep);
      }
    }
    return true;
  });
}

std::shared_ptr<const Scene> RunReader::SceneOf(std::uint64_t scene) {
  return Guard("scene " + std::to_string(scene), [&] { return FindScene(scene); });
}

SavedStatePtr RunReader::Keyframe(std::uint64_t step) {
  const std::string wanted = "the keyframe at or before step " + std::to_string(step);
  return Guard(wanted, [&] {
    Statement row = database().Prepare(
        "SELECT keyframe.step, state, scene, time_ns FROM keyframe LEFT JOIN step USING (step)"
        " WHERE keyframe.step <= ?1 ORDER BY keyframe.step DESC LIMIT 1");
    row.Bind(1, step);
    if (!row.Step()) {
      throw Failure{file_ + ": " + wanted +
                    " is missing: continue from a later time, or copy the file again"};
    }
    const std::int64_t number = row.integer(0), scene = row.integer(2);
    const std::string name = "the keyframe of step " + std::to_string(number);
    if (row.is_null(2) || scene < 0) Damaged(name + " without its step");
    SavedStatePtr state = DecodeState(row.blob(1), FindScene(static_cast<std::uint64_t>(scene)));
    const bool fits = state != nullptr && state->frame->step == static_cast<std::uint64_t>(number) &&
                      state->frame->time == row.integer(3);
    if (!fits) Damaged(name);
    return state;
  });
}

}  // namespace coopdyn
