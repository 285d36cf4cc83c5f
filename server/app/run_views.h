// SPDX-License-Identifier: MIT
// The page's views of a recording besides playback: its timeline, where it diverges from another one, its
// ghost, and its numbers (docs/protocol.md). Pure functions of open recordings; each may take seconds. Any
// thread.
#pragma once

#include <stop_token>
#include <string>

#include "server/record/run_reader.h"
#include "server/replay/state_at.h"
#include "server/web/http_routes.h"

namespace coopdyn {

/// {"name","begin_s","end_s","steps","keyframes":[s],"events":[{"time_s","level","text"}]}; at most the first
/// 10,000 of each.
HttpAnswer TimelineOf(RunReader& run);
/// Where two runs diverge, as `coopdyn verify` finds it:
/// {"equal","steps","time_s","step","what","field","one","other","text"}.
HttpAnswer PartingOf(RunReader& one, RunReader& other, const ReplayServices& services);
/// The first scene, in the format of /api/scene, with number 0.
HttpAnswer SceneOf(RunReader& run);
/// Poses of the first scene, about `rate_hz` per simulated second, each as a u32 length and a pose message.
/// 503 if `stop` is requested meanwhile, like TableOf().
HttpAnswer PosesOf(RunReader& run, double rate_hz, const std::stop_token& stop);
/// The columns of `coopdyn export` for one robot, sensors included, or, if `robot` is empty, the scores and
/// logged numbers; thinned to about `points` rows; CSV.
HttpAnswer TableOf(RunReader& run, const std::string& robot, int points, const std::stop_token& stop);

}  // namespace coopdyn
