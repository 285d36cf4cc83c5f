// SPDX-License-Identifier: MIT
// Chooses by name which robots, things, targets, scores and logged numbers of a run become columns. Pure; any
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
  std::set<ControlMode> modes;  // of the set-points read so far
};

/// A sensor whose readings are exported: computed from the recording with the noise of the run.
struct ReadingColumn {
  std::string module;
  std::vector<std::string> values;  // names of the values: FixedNames()
};

struct RobotColumn {
  std::string name, type;
  std::size_t sensors = 0;  // distance sensors
  std::vector<ChannelColumn> channels;
  std::vector<ReadingColumn> readings;
};

struct TargetColumn {
  TargetId id;
  std::string label;  // red1: the red target with the lowest id
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

/// Numbers of a run besides the contents of its scenes.
struct RunNumbers {
  bool scores = false;              // they were recorded
  std::vector<std::string> logged;  // names
};

/// The columns of a run through `scenes`, in order: robots and things of all scenes, each once, in order of
/// first appearance; scores in the scenario's order, logged numbers by name. If a chosen name is unknown,
/// sets `error`, which suggests a similar name.
RunColumns ChooseColumns(std::span<const std::shared_ptr<const Scene>> scenes, const RunNumbers& numbers,
                         const ExportOptions& options, std::string& error);

}  // namespace coopdyn
