// SPDX-License-Identifier: MIT
// The exact state of a recorded run after any of its steps: steps on from the preceding keyframe with the
// recorded inputs. Branches start from it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/worker_pool.h"
#include "server/controllers/controller_set.h"
#include "server/record/run_reader.h"

namespace coopdyn {

/// The services that a repetition uses; all must outlive it.
struct ReplayServices {
  const Clock& clock;
  const Logger& logger;
  WorkerPool& pool;
  ControllerOptions controllers;
  SearchPath path;  // where loaded controllers are found
};

/// The state after step `step` of the run; its frame has the scene that `reader` made. Null with `error` if
/// the file is damaged, the step is not in it, or the repetition does not reproduce the recorded hashes
/// (another build or library; the text says so). The state's `warning` names controllers that have changed.
/// Takes as long as the steps since the keyframe. Any one thread, while no other thread steps a world.
SavedStatePtr StateAt(RunReader& reader, std::uint64_t step, const ReplayServices& services,
                      std::string& error);

/// The newest step at or before `when`: seconds ("12.5"), a step ("#1200"), `end` or `start`. Nullopt with
/// `error` if `when` cannot be parsed or lies outside the run.
std::optional<std::uint64_t> FindStep(RunReader& reader, const std::string& when, std::string& error);

}  // namespace coopdyn
