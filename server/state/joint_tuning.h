// SPDX-License-Identifier: MIT
// Executes a control board's set_compliance, set_profile and set_gains. Pure; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/state/edits.h"
#include "server/state/frame.h"

namespace coopdyn {

/// True for these three commands.
bool IsTuning(std::int32_t command);
/// Number of values that `command` needs per joint.
std::size_t ValuesPerJoint(std::int32_t command);
/// The joints (from 0) of `count` that a request's ids (from 1) denote; all without ids. `why` is set if the
/// ids are not valid.
std::vector<std::size_t> JointsOf(const std::vector<std::int32_t>& ids, std::size_t count, std::string& why,
                                  const char* what = "joint");
/// Changes the controls of `scene`, all or none. Returns an error text that says what to write instead; empty
/// on success.
std::string TuneControls(const edit::TuneJoints& tuning, const Scene& scene,
                         std::vector<JointControl>& controls);

}  // namespace coopdyn
