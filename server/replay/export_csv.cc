// SPDX-License-Identifier: MIT
#include "server/replay/export_tables.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <vector>

#include "server/model/values.h"
#include "server/record/run_tables.h"
#include "server/replay/export_file.h"
#include "server/replay/run_table.h"

namespace coopdyn {

namespace {

constexpr std::array<const char*, 7> kPoseNames{"x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"};

/// The mode of the channel's set-points; velocity if nothing was commanded.
ControlMode ModeOf(const ChannelColumn& channel) {
  return channel.modes.empty() ? ControlMode::kVelocity : *channel.modes.begin();
}

/// Whether a set-point of the robot is anything but a velocity.
bool ShowsModes(const RobotColumn& robot) {
  return std::any_of(robot.channels.begin(), robot.channels.end(), [](const ChannelColumn& channel) {
    return channel.modes.size() > 1 || ModeOf(channel) != ControlMode::kVelocity;
  });
}

std::string Header(const RunTable& table) {
  const RunColumns& columns = table.columns();
  std::string line = "step,time_s";
  for (const RobotColumn& robot : columns.robots) {
    const auto add = [&](const std::string& field) { line += "," + robot.name + "." + field; };
    for (const char* field : {"x_m", "y_m", "heading_rad"}) add(field);
    if (table.what().channels) {
      for (const ChannelColumn& channel : robot.channels) add(channel.joint + "_" + channel.unit);
      for (const ChannelColumn& channel : robot.channels) {
        add(channel.joint + "_" + SetpointUnit(channel.unit, ControlMode::kVelocity));
      }
    }
    for (std::size_t i = 1; table.what().distances && i <= robot.sensors; ++i)
      add("d" + std::to_string(i) + "_m");
    for (const TargetColumn& target : columns.targets) {
      if (!table.what().targets) break;
      add(target.label + "_distance_m");
      add(target.label + "_bearing_rad");
    }
    for (const ChannelColumn& channel : robot.channels) {
      const std::string setpoint = channel.joint + "_setpoint";
      add(channel.modes.size() > 1 ? setpoint : setpoint + "_" + SetpointUnit(channel.unit, ModeOf(channel)));
    }
    for (const ChannelColumn& channel : robot.channels) {
      if (ShowsModes(robot)) add(channel.joint + "_mode");
    }
    for (const ReadingColumn& reading : robot.readings) {
      for (const std::string& value : reading.values) add(reading.module + "_" + value);
    }
  }
  for (const std::string& object : columns.objects) {
    for (const char* field : kPoseNames) line += "," + object + "." + field;
  }
  for (const ScoreColumn& score : columns.scores) {
    line += ",score." + score.name + (score.unit.empty() ? "" : "_" + ToLower(score.unit));
  }
  for (const std::string& name : columns.logged) line += ",logged." + name;
  return line + ",hash\n";
}

void AppendRow(const RunRow& row, const RunTable& table, std::string& line) {
  const RecordWhat& what = table.what();
  const auto add = [&line](double value) {
    line += ',';
    AppendNumber(value, line);
  };
  const auto add_all = [&add](const auto& values) {
    for (const double value : values) add(value);
  };
  line += std::to_string(row.step);
  add(row.time_s);
  for (std::size_t i = 0; i < row.robots.size(); ++i) {
    const RobotValues& robot = row.robots[i];
    add(robot.X_WR[0]);
    add(robot.X_WR[1]);
    add(robot.heading_rad);
    if (what.channels) add_all(robot.channels);
    if (what.distances) add_all(robot.distances_m);
    if (what.targets) add_all(robot.targets);
    add_all(robot.setpoints.references);
    if (ShowsModes(table.columns().robots[i])) add_all(robot.setpoints.modes);
    add_all(robot.readings);
  }
  for (const PoseValues& object : row.objects) add_all(object);
  add_all(row.scores);
  add_all(row.logged);
  line += ',';
  line += HashText(row.hash);
  line += '\n';
}

std::string WriteEvents(RunTable& table, ExportFile& file) {
  std::vector<Event> events;
  if (std::string error = table.ReadEvents(events); !error.empty()) return error;
  file.Write("step,time_s,level,text\n");
  for (const Event& event : events) {
    std::string line = std::to_string(event.step) + ",";
    AppendNumber(event.time_s, line);
    file.Write(line + "," + event.level + "," + CsvQuoted(event.text) + "\n");
  }
  return file.Close();
}

}  // namespace

void AppendNumber(double value, std::string& text) {
  if (std::isnan(value)) {
    text += "nan";
    return;
  }
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

std::string CsvQuoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string EventsFile(const std::string& out) {
  return WithSuffix(out, "-events.csv");
}

std::string ExportCsv(RunReader& reader, const ExportOptions& options, const std::string& out,
                      const ExportProgress& progress) {
  std::string error;
  const auto table = RunTable::Make(reader, options, error);
  if (table == nullptr) return error;
  ExportFile file(out), events(EventsFile(out));
  if (error = file.Open(options.overwrite); !error.empty()) return error;
  if (error = events.Open(options.overwrite); !error.empty()) return error;
  const auto look = [&progress](double) { return !progress || progress(0); };
  // The names of columns depend on the modes of all set-points.
  if (error = table->ForEach({nullptr, nullptr}, look); !error.empty()) return error;
  file.Write(Header(*table));
  std::uint64_t rows = 0;
  std::string line;
  const auto write_row = [&](const RunRow& row) {
    line.clear();
    AppendRow(row, *table, line);
    file.Write(line);
    ++rows;
  };
  // Stop at once when the disk is full, not at the end.
  const auto proceed = [&](double share) { return !file.failed() && (!progress || progress(share)); };
  error = table->ForEach({write_row, nullptr}, proceed);
  if (!file.failed() && !error.empty()) return error;
  if (!file.failed() && rows == 0) return "no step of this time range was recorded with poses";
  if (error = WriteEvents(*table, events); !error.empty()) return error;
  if (error = file.Commit(); !error.empty()) return error;
  return events.Commit();
}

}  // namespace coopdyn
