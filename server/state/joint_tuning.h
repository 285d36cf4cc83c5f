// SPDX-License-Identifier: MIT
// What set_compliance, set_profile and set_gains of a control board change. Pure; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/state/edits.h"
#include "server/state/frame.h"

namespace coopdyn {

/// It is one of these commands.
bool IsTuning(std::int32_t command);
/// Values that such a command takes for each joint.
std::size_t ValuesPerJoint(std::int32_t command);
/// Which joints (from 0) of `count` the ids of a request mean: all without ids. `why`: they are not such
/// joints.
std::vector<std::size_t> JointsOf(const std::vector<std::int32_t>& ids, std::size_t count, std::string& why,
                                  const char* what = "joint");
/// Changes the controls of `scene`, one and all. Why that cannot be, and what to write instead; empty: done.
std::string TuneControls(const edit::TuneJoints& tuning, const Scene& scene,
                         std::vector<JointControl>& controls);

}  // namespace coopdyn
