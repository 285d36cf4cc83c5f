// SPDX-License-Identifier: MIT
// The commands of step_all for many robots: each word adds columns to every robot's row. Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/message.h"
#include "server/model/robot_model.h"
#include "server/state/scene.h"

namespace coopdyn {

/// A word is `velocities` (linear m/s, angular rad/s), `wheels` (left, right rad/s), or sets joints, one
/// value each (rad, rad/s, N m; sliding joints m, m/s, N): `positions`, `positions_direct`,
/// `joint_velocities` or `efforts` for all of a robot's groups of joints, `positions/arm` for one. A word has
/// as many columns as the robot with the most joints needs; columns beyond a robot's own joints are ignored.
/// NaN in a request with joints leaves that joint unchanged.
class TeamCommands {
 public:
  struct Refusal {
    Error error = Error::kOk;
    std::string text;
  };

  /// Parses the text of step_all; no words mean `velocities`.
  std::optional<Refusal> Read(std::string_view text);
  /// Converts `data`, which must have a row for each of `robots` (indices into the scene), to the `setpoints`
  /// of all their channels. `limited`: number of robots with values beyond their limits.
  std::optional<Refusal> Translate(const Scene& scene, std::span<const int> robots,
                                   std::span<const double> data, std::vector<Setpoint>& setpoints,
                                   std::size_t& limited) const;

 private:
  struct Word {
    std::string name;
    ControlMode mode = ControlMode::kKeep;  // for joints; kKeep: for wheels
    bool wheels = false;                    // wheel speeds, not velocities
    std::string group;                      // empty: all groups

    bool sets_joints() const { return mode != ControlMode::kKeep; }
    bool sets(const ActuatorModel& actuator) const;
  };

  std::size_t Columns(const Word& word, const Scene& scene, std::span<const int> robots) const;
  /// `row`: the word's columns. Adds to `setpoints`, which begin at the robot's first channel.
  std::optional<Refusal> Add(const Word& word, const SceneRobot& robot, std::span<const double> row,
                             std::span<Setpoint> setpoints, bool& limited) const;
  /// Fast path for a single word for wheels, usual for swarms.
  std::optional<Refusal> TranslateWheels(const Scene& scene, std::span<const int> robots,
                                         std::span<const double> data, std::vector<Setpoint>& setpoints,
                                         std::size_t& limited) const;
  bool is_only_wheels() const { return words_.size() == 1 && !words_.front().sets_joints(); }

  std::vector<Word> words_;
};

}  // namespace coopdyn
