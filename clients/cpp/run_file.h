// SPDX-License-Identifier: MIT
// Reads recorded runs, NAME.run; the same names and meaning as in Python and MATLAB. Needs SQLite: link
// coopdyn_run_file.
//
//   const auto run = coopdyn::client::read_run("lesson1.run");
//   const auto pose = run.pose("robot1");             // x, y [m], heading [rad], a row for each moment
//   for (std::size_t i = 0; i < pose.size(); ++i) std::printf("%g,%g\n", pose[i][0], pose[i][1]);
//
// Nothing but what is asked for is read, when it is asked for. Everything throws Error: 10 no such file or
// name, 7 a foreign or damaged file, 5 what was not recorded. A run that is being recorded is read as far as
// it was when it was opened. One thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clients/cpp/error.h"

namespace coopdyn::client {

/// Numbers in rows of the same length, one for each moment of a run: rows[i][j].
class RunRows {
 public:
  RunRows(std::vector<double> values, std::size_t columns, std::size_t rows)
      : values_(std::move(values)), columns_(columns), rows_(rows) {}

  std::size_t size() const { return rows_; }
  std::size_t columns() const { return columns_; }
  /// @pre i < size()
  std::span<const double> operator[](std::size_t i) const {
    return {values_.data() + i * columns_, columns_};
  }
  /// All numbers, row after row.
  const std::vector<double>& values() const { return values_; }

 private:
  std::vector<double> values_;
  std::size_t columns_, rows_;
};

/// What happened: after which step, when [s], "info", "warning", "error" or "note", and what.
struct Event {
  std::int64_t step = 0;
  double time = 0;
  std::string level, text;
};

/// A recorded run. k is the number of recorded moments: the first is the state that recording began with.
/// What was not there, or not recorded at a moment, is nan.
class Run {
 public:
  ~Run();
  Run(Run&&) noexcept;
  Run& operator=(Run&&) noexcept;

  const std::string& file() const;
  /// What is known of the run as a whole: version, started, command, seed, mode, step_ns … (docs/formats.md).
  const std::map<std::string, std::string>& info() const;
  /// The text of the scenario.
  std::string scenario() const;
  /// The names of all robots.
  const std::vector<std::string>& names() const;

  /// Simulated times [s], k of them.
  std::vector<double> time() const;
  /// Numbers of the steps, k of them.
  std::vector<std::int64_t> steps() const;
  /// The hash of the exact state at each moment, 16 hexadecimal digits: equal runs have equal hashes.
  std::vector<std::string> hash() const;
  /// x, y [m] and heading [rad] of a robot; also of an object that moves.
  RunRows pose(const std::string& name) const;
  /// x, y, z [m] and quaternion w, x, y, z in the world.
  RunRows pose_3d(const std::string& name) const;
  /// What a robot read: "distances" [m], right to left, inf = nothing there; "targets": distance [m] and
  /// bearing [rad] of each, nan = not seen; "channels": positions [rad], not wrapped, then velocities [rad/s]
  /// of the m channels that joints(name) names (of a sliding joint [m], [m/s]), 2m columns.
  RunRows reading(const std::string& name, const std::string& what) const;
  /// The names of the joints that a robot's m channels drive: the columns of its channels and commands.
  std::vector<std::string> joints(const std::string& name) const;
  /// The set-points of a robot, a row for each time that some came in force: the step in which they did, time
  /// [s], the set-points of its m channels, and their control modes: 1 position [rad], 3 velocity [rad/s], 4
  /// effort [N m] (0 idle, 2 direct), so 2 + 2m columns. The first row is what was in force when recording
  /// began. Error 5 if a loaded controller drove it and those were not recorded; if a client took it from the
  /// controller, its commands are there.
  RunRows commands(const std::string& name) const;
  /// What happened, in order, notes included.
  std::vector<Event> events() const;
  /// Time [s] and value of a score, k x 2; nan if it cannot be told.
  RunRows score(const std::string& name) const;
  /// What the run was worth at its last moment, by the names of the scenario's [SCORE_n].
  std::map<std::string, double> scores() const;
  /// Time [s] and value of each number that was logged under a name, n x 2.
  RunRows logged(const std::string& name) const;

 private:
  friend Run read_run(const std::string& file);
  struct Impl;
  explicit Run(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Opens a recorded run, NAME.run; also one that is being recorded, or that a crash has left.
Run read_run(const std::string& file);

}  // namespace coopdyn::client
