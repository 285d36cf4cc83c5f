// SPDX-License-Identifier: MIT
// A recorded run as rows of numbers: what the CSV and MAT exports write, so that both hold the same bits. One
// thread, as the reader.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/record/logged_numbers.h"
#include "server/record/player_frames.h"
#include "server/record/run_reader.h"
#include "server/replay/run_columns.h"

namespace coopdyn {

/// x y z (m), quaternion w x y z; all nan while the thing is not in the world.
using PoseValues = std::array<double, 7>;

/// Of the channels of a robot: what is wanted of each, and in which mode (the number of a ControlMode).
struct Setpoints {
  Setpoints() = default;
  explicit Setpoints(std::size_t channels);
  std::vector<double> references, modes;
};

struct RobotValues {
  PoseValues X_WR{};
  double heading_rad = 0;           // in (−π, π]
  std::vector<double> channels;     // positions since the start, then velocities; nan: not recorded
  Setpoints setpoints;              // in force; nan: not recorded
  std::vector<double> distances_m;  // right to left; nan: not recorded
  std::vector<double> targets;      // distance m, bearing rad of each; nan: not seen
  std::vector<double> readings;     // of the chosen sensors, one after the other
};

/// One recorded step that has poses.
struct RunRow {
  std::uint64_t step = 0;
  double time_s = 0;
  std::uint64_t hash = 0;           // of the exact state
  std::vector<RobotValues> robots;  // as the columns
  std::vector<PoseValues> objects;
  std::vector<double> scores;  // nan: it cannot be told
  std::vector<double> logged;  // the newest by then; nan: none yet
};

/// The set-points of a robot after some came in force; with the first step of a file those in force then.
struct CommandRow {
  std::size_t robot = 0;  // its column
  std::uint64_t step = 0;
  double time_s = 0;
  const Setpoints& setpoints;
};

class RunTable {
 public:
  /// What `options` choose of the run of `reader`, which outlives it. Null with `error` ("--from: …" without
  /// the file's name, or the damage).
  /// @pre LoadScenario() of the reader went well
  static std::unique_ptr<RunTable> Make(RunReader& reader, const ExportOptions& options, std::string& error);

  const RunColumns& columns() const { return columns_; }
  /// What was recorded.
  const RecordWhat& what() const { return reader_.header().what; }
  /// No more rows than this; they are not counted exactly before they are read.
  std::uint64_t max_rows() const { return max_rows_; }
  /// Events of the time range, in order. An error text if they cannot be read.
  std::string ReadEvents(std::vector<Event>& events);

  /// What is null is not read.
  struct Uses {
    std::function<void(const RunRow&)> row;
    std::function<void(const CommandRow&)> command;
  };
  /// Reads the rows in order, and notes the modes of set-points in columns(). Returns what is wrong (a
  /// damaged file, stopped); empty if all is well.
  std::string ForEach(const Uses& uses, const ExportProgress& progress);

 private:
  /// Where the columns are in one scene; -1: not there.
  struct Places {
    std::shared_ptr<const Scene> scene;
    std::vector<int> robots, objects, targets;
    std::vector<int> column_of_robot;         // of each robot of the scene
    std::vector<std::size_t> first_distance;  // of each robot of the scene
    std::size_t distances = 0;                // of all its robots
  };

  explicit RunTable(RunReader& reader) : reader_(reader) {}

  // The first three return what is wrong; empty: nothing.
  std::string Choose(const ExportOptions& options);
  std::string Limit(const ExportOptions& options);
  std::string Damage(std::uint64_t step) const;
  Places FindPlaces(std::shared_ptr<const Scene> scene) const;
  const Places* PlacesOf(std::uint64_t scene);
  /// Whether the set-points of `robot` that no client sent are in the file.
  bool HasSetpoints(const SceneRobot& robot) const {
    return what().controllers || robot.entry.controller.empty();
  }
  void TakeSetpoint(std::size_t column, std::size_t channel, const Setpoint& setpoint);
  /// Set-points as they are after a keyframe.
  void TakeSetpoints(const SavedState& state);
  void TakeCommands(const RecordedStep& recorded, const Places& places,
                    const std::function<void(const CommandRow&)>& use);
  void MakeNumbers(const RecordedStep& recorded);
  bool MakeRow(const RecordedStep& recorded, const Places& places);
  /// The chosen sensors of all robots. False if the file is damaged.
  bool MakeReadings(const Places& places);
  void MakeRobot(const RecordedStep& recorded, const Places& places, std::size_t column);
  bool InRange(Nanoseconds time) const { return time >= begin_ && time <= end_; }

  RunReader& reader_;
  RunColumns columns_;
  LoggedNumbers logged_;
  std::uint64_t first_ = 0, last_ = 0;  // steps to read
  Nanoseconds begin_ = 0, end_ = 0;     // times to use, both included
  Nanoseconds every_ = 0;
  std::uint64_t steps_ = 0;  // recorded in that time
  std::uint64_t max_rows_ = 0;
  bool is_checked_ = false;                    // the file's chains
  std::map<std::uint64_t, Places> places_of_;  // by scene number

  // While rows are read:
  std::vector<Setpoints> in_force_;  // of each robot, by column
  Frame frame_;
  std::unique_ptr<PlayFrames> moments_;  // null: no readings are wanted
  RunRow row_;
};

/// Takes one row per `every`, counted from the first that it is shown; all if `every` is 0.
class RowPicker {
 public:
  explicit RowPicker(Nanoseconds every) : every_(every) {}
  bool Takes(Nanoseconds time);

 private:
  Nanoseconds every_;
  std::optional<Nanoseconds> begin_;
  Nanoseconds last_ = 0;  // interval of the row taken last
};

/// Seconds from options as nanoseconds; an error text if they are none.
std::string ToNanoseconds(const char* option, double seconds, Nanoseconds& ns);

/// The frame of a recorded step for those who draw it or look up poses in it: poses, channels, set-points as
/// given (none: zero), velocities zero. False if the step does not fit its scene, which must be that of it.
bool FillFrame(const RecordedStep& recorded, std::shared_ptr<const Scene> scene, const RunHeader& header,
               Frame& frame);

}  // namespace coopdyn
