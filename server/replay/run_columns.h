// SPDX-License-Identifier: MIT
// Which robots, things, targets, scores and logged numbers of a run become columns, chosen by name. Pure; any
// thread.
#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "server/replay/export_file.h"
#include "server/state/scene.h"

namespace coopdyn {

struct ChannelColumn {
  std::string joint;            // ChannelName()
  std::string unit;             // ChannelUnit()
  std::set<ControlMode> modes;  // of the set-points that were read so far
};

/// A sensor whose readings are wanted: computed from what was recorded, with the noise of then.
struct ReadingColumn {
  std::string module;
  std::vector<std::string> values;  // their names, FixedNames()
};

struct RobotColumn {
  std::string name, type;
  std::size_t sensors = 0;  // distance sensors
  std::vector<ChannelColumn> channels;
  std::vector<ReadingColumn> readings;
};

struct TargetColumn {
  TargetId id;
  std::string label;  // red1: the first red one, by increasing id
  std::string color;
  Vector3 p_WT = Vector3::Zero();
};

struct ScoreColumn {
  std::string name, unit;
  std::size_t place = 0;  // among the scores of the scenario
};

struct RunColumns {
  std::vector<RobotColumn> robots;
  std::vector<std::string> objects;
  std::vector<TargetColumn> targets;
  std::vector<ScoreColumn> scores;
  std::vector<std::string> logged;  // names
};

/// What a run has besides the things of its scenes.
struct RunNumbers {
  bool scores = false;              // they were recorded
  std::vector<std::string> logged;  // names
};

/// The columns of a run through `scenes`, in order: robots and things of all of them, each once, in the order
/// of their first appearance; scores in the order of the scenario, logged numbers by name. Sets `error` if a
/// name that was chosen is in none of them; it says which is near.
RunColumns ChooseColumns(std::span<const std::shared_ptr<const Scene>> scenes, const RunNumbers& numbers,
                         const ExportOptions& options, std::string& error);

}  // namespace coopdyn
