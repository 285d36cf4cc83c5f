// SPDX-License-Identifier: MIT
// The options of `coopdyn serve` and `coopdyn play`, which runs the same daemon over a recording.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "server/app/options.h"

namespace CLI {
class App;
}

namespace coopdyn {

/// The raw values CLI11 fills before they are turned into options.
struct RawServe {
  std::string mode, controllers, record_what, on_record_failure, on_controller_failure, recording;
  double step_s = 0;
  double speed = 0;
  std::uint64_t seed = 0;
  double duration_s = 0;
  double record_every_s = 0, start_s = 0;
  int name_port = 0, http_port = 0, robot_threads = 0, spin_us = 0;
  std::uint64_t controller_memory_mib = 0;
  std::string config;  // read before the arguments are: InsertConfig()
};

/// Adds the command. `serve` and `raw` outlive the parsing; then TakeRaw().
void AddServe(CLI::App& app, ServeOptions& serve, RawServe& raw);
void AddPlay(CLI::App& app, ServeOptions& serve, RawServe& raw);
/// Takes what was given to `sub`, one of the two commands. Throws CLI::ValidationError.
void TakeRaw(const CLI::App& sub, const RawServe& raw, ServeOptions& serve);

/// RUN and TIME of RUN@TIME, split at the last @; two empty texts if either is missing.
std::pair<std::string, std::string> SplitMoment(const std::string& from);

}  // namespace coopdyn
