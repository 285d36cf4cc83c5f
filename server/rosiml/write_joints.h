// SPDX-License-Identifier: MIT
// Writes the joints of a model as SDF: drive trains, joints with several axes, the drive, muscles and
// thrusters. Pure; any thread.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/rosiml/connect.h"
#include "server/rosiml/experiment.h"
#include "server/rosiml/names.h"
#include "server/rosiml/write_sdf.h"

namespace coopdyn::rosiml {

/// The SDF names of a model's joints, muscles and thrusters.
struct JointNames {
  std::vector<std::string> joints;                // parallel to Model::links
  std::map<int, std::string> muscles, thrusters;  // of the model, by index into the Movable
};

/// Adds the joints to `written`, which has the bodies. `links`: the bodies' names, by index into
/// Movable::bodies.
JointNames WriteJoints(const Movable& movable, const Model& model, const std::map<int, std::string>& links,
                       const std::string& file, Names& names, WrittenModel& written,
                       Diagnostics& diagnostics);

}  // namespace coopdyn::rosiml
