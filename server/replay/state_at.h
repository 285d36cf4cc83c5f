// SPDX-License-Identifier: MIT
// The exact state of a recorded run after any of its steps: from the keyframe before it, stepped with the
// recorded inputs. What branches begin with.
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

/// What a repetition runs with; all outlives it.
struct ReplayServices {
  const Clock& clock;
  const Logger& logger;
  WorkerPool& pool;
  ControllerOptions controllers;
  SearchPath path;  // where loaded controllers are found
};

/// The state after step `step` of the run, whose frame has the scene that `reader` made. Null with `error` if
/// the file is damaged, the step is not in it, or the repetition does not give the recorded hash there
/// (another build or library; the text says so). Its `warning` names controllers that have
/// changed. Takes as long as the steps since the keyframe. Any one thread, while no other steps a world.
SavedStatePtr StateAt(RunReader& reader, std::uint64_t step, const ReplayServices& services,
                      std::string& error);

/// The newest step at or before `when`: seconds ("12.5"), or `end`, or `start`. Nothing with `error` if it is
/// unreadable or lies outside.
std::optional<std::uint64_t> FindStep(RunReader& reader, const std::string& when, std::string& error);

}  // namespace coopdyn
