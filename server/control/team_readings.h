// SPDX-License-Identifier: MIT
// The readings of many robots as one array: a row per robot, with the columns that a client has selected.
// Units and frames are those of the robots' own modules. The control thread; also computes on the pool's
// threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/base/worker_pool.h"
#include "server/state/frame.h"

namespace coopdyn {

/// The readings selected by one connection's select_readings.
class TeamReadings {
 public:
  static constexpr int kDefaultNearest = 8;
  static constexpr int kMaxNearest = 10'000;

  /// pose distances
  TeamReadings() = default;

  /// Selects readings by words in any order; no words mean pose and distances. Words may also name sensor
  /// modules of the robots in `scene`. Returns an error text.
  std::string Select(std::string_view text, int nearest, const Scene& scene);
  /// `pose distances`
  std::string Names() const;
  /// Number of columns of each selected reading. `sensors`: largest number of distance sensors of a robot.
  std::vector<std::int32_t> Columns(const Scene& scene, std::size_t sensors) const;
  /// Writes the rows of `robots` (indices into the scene; −1: removed, NaN) one after the other into `data`,
  /// which has room for a row of the sum of Columns() per robot.
  ///   pose        x m, y m, heading rad, world frame
  ///   distances   one range m per sensor, right to left; nan beyond the robot's own sensors
  ///   targets     distance m, bearing rad per target by id; inf, nan if unseen
  ///   neighbours  id, distance m, bearing rad of the nearest, nearest first, ties by id; then 0, inf, nan
  ///   wheels      angle left, right rad, speed left, right rad/s
  ///   compass     heading rad; nan: the robot has none
  ///   support     x m, y m, angle rad; nan: the robot has none
  ///   joints      position, velocity, effort per joint of its control boards; nan beyond the robot's own
  ///   a module    of that name, e.g. lidar: its first reading (contact: get_bumper); nan beyond the robot's
  ///   own
  void Fill(const Frame& frame, std::span<const int> robots, std::size_t sensors, WorkerPool& pool,
            std::span<double> data) const;

 private:
  /// An index into the list above, or a module's name.
  using Kind = std::variant<std::size_t, std::string>;
  static std::string NameOf(const Kind& kind);

  std::vector<Kind> kinds_{std::size_t{0}, std::size_t{1}};
  int nearest_ = kDefaultNearest;
};

}  // namespace coopdyn
