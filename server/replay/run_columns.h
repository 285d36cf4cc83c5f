// SPDX-License-Identifier: MIT
// Which robots, things and targets of a run become columns, chosen by name. Pure; any thread.
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

struct RunColumns {
  std::vector<RobotColumn> robots;
  std::vector<std::string> objects;
  std::vector<TargetColumn> targets;
};

/// The columns of a run through `scenes`, in order: robots and things of all of them, each once, in the order
/// of their first appearance. Sets `error` if a name that was chosen is in none of them; it says which is
/// near.
RunColumns ChooseColumns(std::span<const std::shared_ptr<const Scene>> scenes, const ExportOptions& options,
                         std::string& error);

}  // namespace coopdyn
