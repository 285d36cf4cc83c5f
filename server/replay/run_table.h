// SPDX-License-Identifier: MIT
// A recorded run as rows of numbers. The CSV and MAT exports both write these rows, so both contain the same
// bits. One thread, the reader's.
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

/// The set-points of a robot's channels: references and modes (the number of a ControlMode).
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
  std::vector<double> readings;     // of the chosen sensors, concatenated
};

/// One recorded step that has poses.
struct RunRow {
  std::uint64_t step = 0;
  double time_s = 0;
  std::uint64_t hash = 0;           // of the exact state
  std::vector<RobotValues> robots;  // in the order of the columns
  std::vector<PoseValues> objects;
  std::vector<double> scores;  // nan: undefined
  std::vector<double> logged;  // the newest numbers so far; nan: none yet
};

/// A robot's set-points after some came into force; for the first step of a file, all in force.
struct CommandRow {
  std::size_t robot = 0;  // its column
  std::uint64_t step = 0;
  double time_s = 0;
  const Setpoints& setpoints;
};

class RunTable {
 public:
  /// The part of the run of `reader` that `options` select. `reader` must outlive the table. Null with
  /// `error` ("--from: …" without the file's name, or the damage).
  /// @pre LoadScenario() of the reader succeeded
  static std::unique_ptr<RunTable> Make(RunReader& reader, const ExportOptions& options, std::string& error);

  const RunColumns& columns() const { return columns_; }
  /// The recorded parts.
  const RecordWhat& what() const { return reader_.header().what; }
  /// An upper bound of the number of rows; the exact number is known only after reading.
  std::uint64_t max_rows() const { return max_rows_; }
  /// Reads the events of the time range, in order. Returns an error text if that fails.
  std::string ReadEvents(std::vector<Event>& events);

  /// Callbacks of ForEach(). Rows or commands with a null callback are not read.
  struct Uses {
    std::function<void(const RunRow&)> row;
    std::function<void(const CommandRow&)> command;
  };
  /// Reads the rows in order and notes the modes of set-points in columns(). Returns an error text (a damaged
  /// file, stopped); empty on success.
  std::string ForEach(const Uses& uses, const ExportProgress& progress);

 private:
  /// Indices of the columns' things in one scene; -1: not there.
  struct Places {
    std::shared_ptr<const Scene> scene;
    std::vector<int> robots, objects, targets;
    std::vector<int> column_of_robot;         // of each robot of the scene
    std::vector<std::size_t> first_distance;  // of each robot of the scene
    std::size_t distances = 0;                // of all robots of the scene
  };

  explicit RunTable(RunReader& reader) : reader_(reader) {}

  // The first three return an error text; empty on success.
  std::string Choose(const ExportOptions& options);
  std::string Limit(const ExportOptions& options);
  std::string Damage(std::uint64_t step) const;
  Places FindPlaces(std::shared_ptr<const Scene> scene) const;
  const Places* PlacesOf(std::uint64_t scene);
  /// Whether the file has the set-points of `robot` that no client sent.
  bool HasSetpoints(const SceneRobot& robot) const {
    return what().controllers || robot.entry.controller.empty();
  }
  void TakeSetpoint(std::size_t column, std::size_t channel, const Setpoint& setpoint);
  /// Takes the set-points of a keyframe.
  void TakeSetpoints(const SavedState& state);
  void TakeCommands(const RecordedStep& recorded, const Places& places,
                    const std::function<void(const CommandRow&)>& use);
  void MakeNumbers(const RecordedStep& recorded);
  bool MakeRow(const RecordedStep& recorded, const Places& places);
  /// Computes the readings of the chosen sensors of all robots. False if the file is damaged.
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
  bool is_checked_ = false;                    // the file's chains have been checked
  std::map<std::uint64_t, Places> places_of_;  // by scene number

  // While rows are read:
  std::vector<Setpoints> in_force_;  // of each robot, by column
  Frame frame_;
  std::unique_ptr<PlayFrames> moments_;  // null: no readings are exported
  RunRow row_;
};

/// Picks one row per interval `every`, counted from the first row offered; all rows if `every` is 0.
class RowPicker {
 public:
  explicit RowPicker(Nanoseconds every) : every_(every) {}
  bool Takes(Nanoseconds time);

 private:
  Nanoseconds every_;
  std::optional<Nanoseconds> begin_;
  Nanoseconds last_ = 0;  // interval of the row picked last
};

/// Converts seconds of an option to nanoseconds. Returns an error text if `seconds` is not a usable time.
std::string ToNanoseconds(const char* option, double seconds, Nanoseconds& ns);

/// Fills `frame` from a recorded step, for drawing and for looking up poses: poses, channels and set-points
/// as recorded (zero if not), velocities zero. False if the step does not fit `scene`, its scene.
bool FillFrame(const RecordedStep& recorded, std::shared_ptr<const Scene> scene, const RunHeader& header,
               Frame& frame);

}  // namespace coopdyn
