// SPDX-License-Identifier: MIT
// What step_all tells many robots: words, each of which gives every robot's row some columns. Pure.
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

/// Each word is `velocities` (linear m/s, angular rad/s), `wheels` (left, right rad/s), or sets joints, one
/// value each (rad, rad/s, N m; of sliding joints m, m/s, N): `positions`, `positions_direct`,
/// `joint_velocities` or `efforts` of all of a robot's groups of joints, `positions/arm` of one. A word has
/// as many columns as the robot with the most joints. What lies beyond a robot's own is not looked at; nan in
/// a request with joints: this one goes on as it does.
class TeamCommands {
 public:
  struct Refusal {
    Error error = Error::kOk;
    std::string text;
  };

  /// Reads the text of step_all; without words velocities.
  std::optional<Refusal> Read(std::string_view text);
  /// Fails unless `data` has a row for each of `robots` (indices into the scene). Then `setpoints` are those
  /// of all their channels, and `limited` says how many robots had some beyond their limits.
  std::optional<Refusal> Translate(const Scene& scene, std::span<const int> robots,
                                   std::span<const double> data, std::vector<Setpoint>& setpoints,
                                   std::size_t& limited) const;

 private:
  struct Word {
    std::string name;
    ControlMode mode = ControlMode::kKeep;  // of joints; kKeep: of wheels
    bool wheels = false;                    // not velocities
    std::string group;                      // empty: all

    bool sets_joints() const { return mode != ControlMode::kKeep; }
    bool sets(const ActuatorModel& actuator) const;
  };

  std::size_t Columns(const Word& word, const Scene& scene, std::span<const int> robots) const;
  /// `row`: the word's columns. Adds to `setpoints`, which begin with the robot's first channel.
  std::optional<Refusal> Add(const Word& word, const SceneRobot& robot, std::span<const double> row,
                             std::span<Setpoint> setpoints, bool& limited) const;
  /// The same if all that is said is one word for wheels: swarms step so.
  std::optional<Refusal> TranslateWheels(const Scene& scene, std::span<const int> robots,
                                         std::span<const double> data, std::vector<Setpoint>& setpoints,
                                         std::size_t& limited) const;
  bool is_only_wheels() const { return words_.size() == 1 && !words_.front().sets_joints(); }

  std::vector<Word> words_;
};

}  // namespace coopdyn
