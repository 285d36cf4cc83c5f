// SPDX-License-Identifier: MIT
// Drives any number of robots together through one connection. One thread, that of their simulation.
//
//   auto team = sim.team("swarm1");
//   auto s = team.read();
//   std::vector<double> v(2 * team.n());             // forward [m/s], turn [rad/s] for each robot
//   for (int k = 0; k < 1000; ++k) {
//     for (std::size_t i = 0; i < team.n(); ++i) v[2 * i] = s.distances[i][0] < 0.05 ? 0.0 : 0.1;
//     s = team.step(v);                              // the readings after the step
//   }
//   team.close();
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "protocol/message.h"

namespace coopdyn::client {

class Session;
struct TeamLink;

inline constexpr double kNoTimeout_s = std::numeric_limits<double>::infinity();

/// Rows of numbers of equal length, one per robot of a team: rows[i][j].
class Rows {
 public:
  Rows() = default;
  /// `first` points to the first number; rows are `stride` numbers apart.
  Rows(const double* first, std::size_t rows, std::size_t columns, std::size_t stride)
      : first_(first), rows_(rows), columns_(columns), stride_(stride) {}

  std::size_t size() const { return rows_; }
  std::size_t columns() const { return columns_; }
  /// Throws Error 4 if there is no such row, e.g. because the reading was not selected.
  std::span<const double> operator[](std::size_t i) const {
    if (i >= rows_) NoSuchRow(i);
    return {first_ + i * stride_, columns_};
  }

 private:
  [[noreturn]] void NoSuchRow(std::size_t i) const;

  const double* first_ = nullptr;
  std::size_t rows_ = 0, columns_ = 0, stride_ = 0;
};

/// The readings of a team in one step that Team::select chose, in rows in the order of Team::names; other
/// readings have no rows. Copies share the numbers.
struct TeamReading {
  double time = 0;
  std::int64_t step = 0;
  std::string text;                     // reports limited speeds and robots taken from the team
  Rows pose;                            // x, y [m], heading [rad]
  Rows distances;                       // [m], right to left
  Rows targets;                         // distance [m], bearing [rad] of each target
  Rows neighbours;                      // id, distance [m], bearing [rad] of each; 0, inf, nan: no more
  Rows wheels;                          // angles [rad] left, right, speeds [rad/s] left, right
  Rows compass;                         // heading [rad]; nan without one
  Rows support;                         // x, y [m], angle [rad] of the load; nan without one
  Rows joints;                          // position, velocity, effort of each; nan: no more
  std::map<std::string, Rows> modules;  // sensor modules by name; nan where a robot has fewer values
  std::shared_ptr<const std::vector<double>> values;  // storage of the rows
};

/// One kind of command for the robots of a team. `name`: "velocities" (forward [m/s], turn [rad/s]), "wheels"
/// (left, right [rad/s]); "positions", "positions_direct", "joint_velocities", "efforts" of all joints, or of
/// one group ("positions/arm"), with one value for each joint [rad, rad/s, N m; m, m/s, N].
struct TeamCommand {
  std::string name;
  /// A row for each robot, or one for all. Rows of robots with fewer joints may be shorter; nan: this joint
  /// keeps its command.
  std::vector<std::vector<double>> rows;
};

/// While a recording is played, a team can only be read; functions that drive it throw Error 5.
class Team {
 public:
  /// Number, names and ids of the robots, in the order of the rows.
  std::size_t n() const;
  const std::vector<std::string>& names() const;
  const std::vector<std::int32_t>& ids() const;

  /// Runs one step of the world: sets each robot's forward speed [m/s] and turn rate [rad/s], waits until the
  /// step has run, in every mode, and returns the readings after it. V holds two numbers per robot, row by
  /// row, or two for all; empty: the robots keep their speeds. In lockstep the other robots of this sim step,
  /// too, with their kept commands. Error 11 after `timeout` seconds.
  TeamReading step(std::span<const double> V = {}, double timeout = kNoTimeout_s);
  /// The same with joints, or several kinds of commands:
  ///   team.step({{"velocities", V}, {"positions/arm", {{0.5, 0.2, 0}}}});
  TeamReading step(std::initializer_list<TeamCommand> commands, double timeout = kNoTimeout_s);
  /// The same with the speeds of the left and right wheel [rad/s].
  TeamReading step_wheels(std::span<const double> W, double timeout = kNoTimeout_s);
  /// The readings of the newest step, without a step.
  TeamReading read();
  /// Selects the readings that step() and read() return: "pose", "distances", "targets", "neighbours" (the
  /// `neighbours` nearest), "wheels", "compass", "support", "joints", and names of sensor modules such as
  /// "lidar". Default: "pose" and "distances". Other readings cost nothing.
  void select(const std::vector<std::string>& readings, int neighbours = 8);
  /// Stops all robots of the team.
  void stop();
  /// Releases the robots; they keep executing their last commands.
  void release();
  /// Stops and releases the robots.
  void close();

 private:
  friend class Simulation;
  Team(std::shared_ptr<Session> session, std::shared_ptr<TeamLink> link);
  TeamReading Step(std::span<const double> values, const char* what, const char* columns, const char* text,
                   double timeout);
  /// Runs the step. `rows` makes its data, and is called again if robots were taken away meanwhile.
  TeamReading Step(const std::function<std::span<const double>()>& rows, const std::string& text, bool reads,
                   double timeout);
  TeamReading ToReading(Message reply, int tries_left = 3);

  std::shared_ptr<Session> session_;
  std::shared_ptr<TeamLink> link_;
};

}  // namespace coopdyn::client
