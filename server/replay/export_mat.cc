// SPDX-License-Identifier: MIT
#include "server/replay/export_tables.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <new>
#include <system_error>
#include <utility>
#include <vector>

#include "server/replay/export_file.h"
#include "server/replay/mat_value.h"
#include "server/replay/run_table.h"

namespace coopdyn {

namespace {

/// The format's limit for one variable, less a margin for uncounted bytes.
constexpr std::uint64_t kFormatLimit = (std::uint64_t{1} << 31U) - (std::uint64_t{1} << 20U);

/// Share of the export's time; writing also compresses.
constexpr double kShareOfReading = 0.25;

constexpr std::array kRunFields{"file", "scenario", "seed",    "version", "time",   "step",   "names",
                                "hash", "robots",   "objects", "targets", "events", "scores", "logged"};
constexpr std::array kRobotFields{"name",     "type",      "pose",         "pose_3d",   "joints",
                                  "channels", "setpoints", "modes",        "distances", "targets",
                                  "commands", "readings",  "reading_names"};
constexpr std::array kObjectFields{"name", "pose_3d"};
constexpr std::array kScoreFields{"name", "unit", "value"};
constexpr std::array kLoggedFields{"name", "value"};
constexpr std::array kTargetFields{"color", "x", "y", "z"};
constexpr std::array kEventFields{"step", "time_s", "level", "text"};

struct RobotMatrices {
  MatMatrix pose, pose_3d, channels, setpoints, modes, distances, targets, commands, readings;
};

/// The numbers of a run; must outlive the values that reference them.
struct RunMatrices {
  MatMatrix time, step;
  std::vector<std::string> hashes;
  std::vector<RobotMatrices> robots;
  std::vector<MatMatrix> objects, scores, logged;
};

/// The values of the chosen sensors: imu_ax_m_s2, …
std::vector<std::string> NamesOf(const RobotColumn& robot) {
  std::vector<std::string> names;
  for (const ReadingColumn& reading : robot.readings) {
    for (const std::string& value : reading.values) names.push_back(reading.module + "_" + value);
  }
  return names;
}

/// Total columns of a robot's matrices with one row per step.
std::uint64_t ColumnsOf(const RobotColumn& robot, const RunColumns& columns, const RecordWhat& what) {
  return 3 + 7 + (what.channels ? 4 : 2) * robot.channels.size() + (what.distances ? robot.sensors : 0) +
         (what.targets ? 2 * columns.targets.size() : 0) + NamesOf(robot).size();
}

/// An upper bound of the file's bytes, without commands and texts.
std::uint64_t MaxBytes(const RunTable& table) {
  constexpr std::uint64_t kHash = 16, kPerRobot = 1024;
  const RunColumns& columns = table.columns();
  std::uint64_t row = 2 * sizeof(double) + 2 * kHash, around = 4096;
  for (const RobotColumn& robot : columns.robots)
    row += sizeof(double) * ColumnsOf(robot, columns, table.what());
  const std::size_t numbers = columns.scores.size() + columns.logged.size();
  row += columns.objects.size() * sizeof(PoseValues) + numbers * sizeof(double);
  around += (columns.robots.size() + columns.objects.size() + numbers) * kPerRobot;
  return table.max_rows() * row + around;
}

/// Available memory in bytes; nullopt if unknown.
std::optional<std::uint64_t> FreeMemory() {
  std::ifstream file("/proc/meminfo");
  for (std::string word; file >> word;) {
    std::uint64_t kb = 0;
    if (word == "MemAvailable:" && file >> kb) return kb * 1024;
  }
  return std::nullopt;
}

std::string TooMuch(const std::string& out, const std::string& why) {
  return out + ": " + why +
         ": choose robots with --robots, a time range with --from and --until, or fewer rows with --every "
         "0.1";
}

std::string TooLarge(std::uint64_t bytes) {
  return fmt::format("this run is {:.1f} GB of numbers, a MAT file holds 2.1",
                     static_cast<double>(bytes) / 1e9);
}

/// Why this table is too large for a MAT file; empty if it is not.
std::string CheckSize(const RunTable& table, const std::string& out) {
  const std::uint64_t bytes = MaxBytes(table);
  const double gigabytes = static_cast<double>(bytes) / 1e9;
  if (bytes > kFormatLimit) return TooMuch(out, TooLarge(bytes));
  const auto free = FreeMemory();
  if (free && bytes > *free) {
    return TooMuch(out, fmt::format("this run takes {:.1f} GB of memory to export, {:.1f} GB are free",
                                    gigabytes, static_cast<double>(*free) / 1e9));
  }
  return {};
}

RunMatrices MakeMatrices(const RunTable& table) {
  const auto rows = static_cast<std::size_t>(table.max_rows());
  const RunColumns& columns = table.columns();
  const RecordWhat& what = table.what();
  RunMatrices run;
  run.time = run.step = MatMatrix(1, rows);
  run.hashes.reserve(rows);
  for (const RobotColumn& robot : columns.robots) {
    run.robots.push_back({MatMatrix(3, rows), MatMatrix(7, rows),
                          what.channels ? MatMatrix(2 * robot.channels.size(), rows) : MatMatrix(),
                          MatMatrix(robot.channels.size(), rows), MatMatrix(robot.channels.size(), rows),
                          what.distances ? MatMatrix(robot.sensors, rows) : MatMatrix(),
                          what.targets ? MatMatrix(2 * columns.targets.size(), rows) : MatMatrix(),
                          MatMatrix(2 + 2 * robot.channels.size(), 0),
                          robot.readings.empty() ? MatMatrix() : MatMatrix(NamesOf(robot).size(), rows)});
  }
  for (std::size_t i = 0; i < columns.objects.size(); ++i) run.objects.emplace_back(7, rows);
  run.scores.assign(columns.scores.size(), MatMatrix(1, rows));
  run.logged.assign(columns.logged.size(), MatMatrix(1, rows));
  return run;
}

void AppendRow(const RunRow& row, const RecordWhat& what, RunMatrices& run) {
  const auto step = static_cast<double>(row.step);
  run.time.Append({&row.time_s, 1});
  run.step.Append({&step, 1});
  run.hashes.push_back(HashText(row.hash));
  for (std::size_t i = 0; i < row.robots.size(); ++i) {
    const RobotValues& values = row.robots[i];
    RobotMatrices& robot = run.robots[i];
    robot.pose.Append(std::array{values.X_WR[0], values.X_WR[1], values.heading_rad});
    robot.pose_3d.Append(values.X_WR);
    if (what.channels) robot.channels.Append(values.channels);
    robot.setpoints.Append(values.setpoints.references);
    robot.modes.Append(values.setpoints.modes);
    if (what.distances) robot.distances.Append(values.distances_m);
    if (what.targets) robot.targets.Append(values.targets);
    if (!values.readings.empty()) robot.readings.Append(values.readings);
  }
  for (std::size_t i = 0; i < row.objects.size(); ++i) run.objects[i].Append(row.objects[i]);
  for (std::size_t i = 0; i < row.scores.size(); ++i) run.scores[i].Append({&row.scores[i], 1});
  for (std::size_t i = 0; i < row.logged.size(); ++i) run.logged[i].Append({&row.logged[i], 1});
}

MatValue RobotsValue(const RunColumns& columns, RunMatrices& run) {
  MatStruct robots(nullptr, columns.robots.size(), kRobotFields);
  for (std::size_t i = 0; i < columns.robots.size(); ++i) {
    RobotMatrices& robot = run.robots[i];
    std::vector<std::string> joints;
    for (const ChannelColumn& channel : columns.robots[i].channels) joints.push_back(channel.joint);
    robots.Set("name", MatText(columns.robots[i].name), i);
    robots.Set("type", MatText(columns.robots[i].type), i);
    robots.Set("pose", robot.pose.View(), i);
    robots.Set("pose_3d", robot.pose_3d.View(), i);
    robots.Set("joints", MatCell(joints), i);
    robots.Set("channels", robot.channels.View(), i);
    robots.Set("setpoints", robot.setpoints.View(), i);
    robots.Set("modes", robot.modes.View(), i);
    robots.Set("distances", robot.distances.View(), i);
    robots.Set("targets", robot.targets.View(), i);
    robots.Set("commands", robot.commands.View(), i);
    robots.Set("readings", robot.readings.View(), i);
    robots.Set("reading_names", MatCell(NamesOf(columns.robots[i])), i);
  }
  return robots.Take();
}

MatValue ObjectsValue(const RunColumns& columns, RunMatrices& run) {
  MatStruct objects(nullptr, columns.objects.size(), kObjectFields);
  for (std::size_t i = 0; i < columns.objects.size(); ++i) {
    objects.Set("name", MatText(columns.objects[i]), i);
    objects.Set("pose_3d", run.objects[i].View(), i);
  }
  return objects.Take();
}

MatValue TargetsValue(const RunColumns& columns) {
  MatStruct targets(nullptr, columns.targets.size(), kTargetFields);
  for (std::size_t i = 0; i < columns.targets.size(); ++i) {
    const TargetColumn& target = columns.targets[i];
    targets.Set("color", MatText(target.color), i);
    targets.Set("x", MatNumber(target.p_WT.x()), i);
    targets.Set("y", MatNumber(target.p_WT.y()), i);
    targets.Set("z", MatNumber(target.p_WT.z()), i);
  }
  return targets.Take();
}

MatValue ScoresValue(const RunColumns& columns, RunMatrices& run) {
  MatStruct scores(nullptr, columns.scores.size(), kScoreFields);
  for (std::size_t i = 0; i < columns.scores.size(); ++i) {
    scores.Set("name", MatText(columns.scores[i].name), i);
    scores.Set("unit", MatText(columns.scores[i].unit), i);
    scores.Set("value", run.scores[i].View(), i);
  }
  return scores.Take();
}

MatValue LoggedValue(const RunColumns& columns, RunMatrices& run) {
  MatStruct logged(nullptr, columns.logged.size(), kLoggedFields);
  for (std::size_t i = 0; i < columns.logged.size(); ++i) {
    logged.Set("name", MatText(columns.logged[i]), i);
    logged.Set("value", run.logged[i].View(), i);
  }
  return logged.Take();
}

MatValue EventsValue(const std::vector<Event>& all) {
  MatStruct events(nullptr, all.size(), kEventFields);
  for (std::size_t i = 0; i < all.size(); ++i) {
    events.Set("step", MatNumber(static_cast<double>(all[i].step)), i);
    events.Set("time_s", MatNumber(all[i].time_s), i);
    events.Set("level", MatText(all[i].level), i);
    events.Set("text", MatText(all[i].text), i);
  }
  return events.Take();
}

MatValue RunValue(RunReader& reader, const RunTable& table, const std::vector<Event>& events,
                  RunMatrices& run) {
  const RunHeader& header = reader.header();
  const RunColumns& columns = table.columns();
  std::vector<std::string> names;
  for (const RobotColumn& robot : columns.robots) names.push_back(robot.name);
  MatStruct value("run", 1, kRunFields);
  value.Set("file", MatText(reader.file()));
  value.Set("scenario", MatText(header.scenario_text));
  value.Set("seed", MatNumber(header.seed));
  value.Set("version", MatText(header.version));
  value.Set("time", run.time.View());
  value.Set("step", run.step.View());
  value.Set("names", MatCell(names));
  value.Set("hash", MatLines(run.hashes));
  value.Set("robots", RobotsValue(columns, run));
  value.Set("objects", ObjectsValue(columns, run));
  value.Set("targets", TargetsValue(columns));
  value.Set("events", EventsValue(events));
  value.Set("scores", ScoresValue(columns, run));
  value.Set("logged", LoggedValue(columns, run));
  return value.Take();
}

/// Writes the file. libmatio ignores the results of its writes: reserve the room first, and at the end check
/// the size against the size in the file's header.
std::string Write(MatValue value, const std::string& version, ExportFile& file) {
  const std::uint64_t bytes = MatBytes(*value);
  if (bytes > kFormatLimit) return TooMuch(file.path(), TooLarge(bytes));
  constexpr std::uint64_t kHeader = 128, kTag = 8;
  const std::string title = "MATLAB 5.0 MAT-file, written by coopdyn " + version;
  const std::string failed = file.path() + " cannot be written: the disk may be full";
  mat_t* mat = Mat_CreateVer(file.temporary().c_str(), title.c_str(), MAT_FT_MAT5);
  if (mat == nullptr) return failed;
  const std::string full = file.Reserve(bytes + bytes / 1000 + 4096);
  const bool written = full.empty() && Mat_VarWrite(mat, value.get(), MAT_COMPRESSION_ZLIB) == 0;
  const bool closed = Mat_Close(mat) == 0;
  if (!full.empty()) return full;
  std::ifstream back(file.temporary(), std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::uint64_t>(back.tellg());
  std::uint32_t said = 0;
  back.seekg(kHeader + 4);
  back.read(reinterpret_cast<char*>(&said), sizeof said);
  if (!written || !closed || !back || size != kHeader + kTag + said) return failed;
  file.Trim(size);
  return {};
}

/// Calls Write() on its own thread and `progress` meanwhile. Writing cannot be interrupted.
std::string WriteWatched(MatValue value, const std::string& version, const ExportProgress& progress,
                         ExportFile& file) {
  constexpr double kShrunk = 0.2;  // typical compression of runs' numbers
  constexpr auto kPeriod = std::chrono::milliseconds(100);
  const double expected = kShrunk * static_cast<double>(MatBytes(*value));
  bool stopped = false;
  std::future<std::string> writing =
      std::async(std::launch::async, [&] { return Write(std::move(value), version, file); });
  while (writing.wait_for(kPeriod) != std::future_status::ready) {
    std::error_code ignored;
    const auto size = static_cast<double>(std::filesystem::file_size(file.temporary(), ignored));
    const double share = std::min(size / expected, 1.0);
    stopped = stopped || (progress && !progress(kShareOfReading + (1 - kShareOfReading) * share));
  }
  const std::string error = writing.get();
  return error.empty() && stopped ? kExportStopped : error;
}

}  // namespace

std::string ExportMat(RunReader& reader, const ExportOptions& options, const std::string& out,
                      const ExportProgress& progress) try {
  std::string error;
  const auto table = RunTable::Make(reader, options, error);
  if (table == nullptr) return error;
  if (error = CheckSize(*table, out); !error.empty()) return error;
  ExportFile file(out);
  if (error = file.Open(options.overwrite); !error.empty()) return error;
  RunMatrices run = MakeMatrices(*table);
  const auto take_row = [&](const RunRow& row) { AppendRow(row, table->what(), run); };
  const auto take_command = [&](const CommandRow& command) {
    std::vector<double> row{static_cast<double>(command.step), command.time_s};
    for (const std::vector<double>* values : {&command.setpoints.references, &command.setpoints.modes}) {
      row.insert(row.end(), values->begin(), values->end());
    }
    run.robots[command.robot].commands.Append(row);
  };
  const auto reading = [&](double share) { return !progress || progress(kShareOfReading * share); };
  error = table->ForEach({take_row, take_command}, reading);
  if (!error.empty()) return error;
  if (run.hashes.empty()) return "no step of this time range was recorded with poses";
  std::vector<Event> events;
  if (error = table->ReadEvents(events); !error.empty()) return error;
  error = WriteWatched(RunValue(reader, *table, events, run), reader.header().version, progress, file);
  if (!error.empty()) return error;
  return file.Commit();
} catch (const std::bad_alloc&) {
  return TooMuch(out, "there is not enough memory for this run");
} catch (const std::system_error& failed) {  // no more threads
  return out + " cannot be written: " + failed.what();
}

}  // namespace coopdyn
