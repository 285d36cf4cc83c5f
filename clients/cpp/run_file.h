// SPDX-License-Identifier: MIT
// Reads recorded runs, NAME.run, with the same names and semantics as in Python and MATLAB. Needs SQLite:
// link coopdyn_run_file.
//
//   const auto run = coopdyn::client::read_run("lesson1.run");
//   const auto pose = run.pose("robot1");             // x, y [m], heading [rad], one row per moment
//   for (std::size_t i = 0; i < pose.size(); ++i) std::printf("%g,%g\n", pose[i][0], pose[i][1]);
//
// Each call reads only the data it returns. Any function may throw Error: 10 no such file or name, 7 a
// foreign or damaged file, 5 not recorded. A run that is still being recorded is read up to its end at the
// time of opening. One thread.
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

/// Rows of numbers of equal length, one per moment of a run: rows[i][j].
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

/// An event after a step, at a simulated time [s]. `level`: "info", "warning", "error" or "note".
struct Event {
  std::int64_t step = 0;
  double time = 0;
  std::string level, text;
};

/// A recorded run. k is the number of recorded moments; the first is the state at the recording's start.
/// Values that did not exist or were not recorded at a moment are nan.
class Run {
 public:
  ~Run();
  Run(Run&&) noexcept;
  Run& operator=(Run&&) noexcept;

  const std::string& file() const;
  /// Properties of the whole run: version, started, command, seed, mode, step_ns … (docs/formats.md).
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
  /// x, y [m] and heading [rad] of a robot or a moving object.
  RunRows pose(const std::string& name) const;
  /// x, y, z [m] and quaternion w, x, y, z in the world.
  RunRows pose_3d(const std::string& name) const;
  /// A robot's readings: "distances" [m], right to left, inf = nothing there; "targets": distance [m] and
  /// bearing [rad] of each, nan = not seen; "channels": positions [rad], not wrapped, then velocities [rad/s]
  /// (sliding joints: [m], [m/s]) of the m channels in the order of joints(name), 2m columns.
  RunRows reading(const std::string& name, const std::string& what) const;
  /// The names of the joints that a robot's m channels drive: the columns of its channels and commands.
  std::vector<std::string> joints(const std::string& name) const;
  /// The set-points of a robot, one row per change: the step of the change, time [s], the set-points of its m
  /// channels, and their control modes: 1 position [rad], 3 velocity [rad/s], 4 effort [N m] (0 idle, 2
  /// direct), so 2 + 2m columns. The first row is in force at the recording's start. Error 5 if a loaded
  /// controller drove the robot and its commands were not recorded; commands of a client that took the robot
  /// over are recorded.
  RunRows commands(const std::string& name) const;
  /// All events in order, including notes.
  std::vector<Event> events() const;
  /// Time [s] and value of a score, k x 2; nan: undefined.
  RunRows score(const std::string& name) const;
  /// The scores at the last moment, by the names of the scenario's [SCORE_n].
  std::map<std::string, double> scores() const;
  /// Time [s] and value of each number logged under a name, n x 2.
  RunRows logged(const std::string& name) const;

 private:
  friend Run read_run(const std::string& file);
  struct Impl;
  explicit Run(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Opens a recorded run, NAME.run, which may still be recorded or stem from a crashed daemon.
Run read_run(const std::string& file);

}  // namespace coopdyn::client
