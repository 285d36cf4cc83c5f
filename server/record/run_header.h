// SPDX-License-Identifier: MIT
// A recording's description of the run as a whole: table `meta` and the embedded texts.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/model/scenario.h"
#include "server/record/recorded_step.h"

namespace coopdyn {

inline constexpr int kRunFormat = 2;                           // schema version
inline constexpr std::int64_t kRunApplicationId = 0x434F4F50;  // "COOP": SQLite's application_id

/// A loaded controller or library of the run.
struct PluginHash {
  std::string name;  // as in the scenario; for a library its file name
  std::string hash;  // FileHash() when the recording began
};

struct RunHeader {
  std::string version;  // of coopdyn
  std::string build;    // BuildId(): equal build and `libraries` compute the same bits
  std::string cpu;      // model name
  std::string started;  // UTC, ISO 8601
  std::string command;  // command line; informative
  std::string scenario_name, scenario_file;
  std::string scenario_text;
  std::string scores;                      // "reach, distance m": names and units, as in table `step`
  std::vector<SourceText> sources;         // worlds and robot models that the scenario names
  std::uint64_t scenario_seed = 1;         // used to read the texts (places of swarms)
  std::uint64_t seed = 1;                  // of noise and solver
  Mode mode = Mode::kRealtime;             // at the start
  Nanoseconds step_length = kDefaultStep;  // at the start
  std::optional<int> substeps;
  RecordWhat what;
  Nanoseconds pose_every = 0;  // 0: each step
  std::vector<PluginHash> controllers;
  std::vector<PluginHash> libraries;  // LibrariesHere()
};

/// FileHash() of the running program's file.
std::string BuildId();
/// Third-party libraries in this process whose computations affect a run's hash, by file.
std::vector<PluginHash> LibrariesHere();
/// XXH3-64 of the bytes of `file`, 16 hex digits; empty if it cannot be read.
std::string FileHash(const std::string& file);
/// Digests that identify the run's inputs: "build", "scenario", "robot coopbot", "controller diffuse", … each
/// with 16 hex digits.
std::map<std::string, std::string> DigestsOf(const RunHeader& header);
/// The processor's model name from /proc/cpuinfo.
std::string CpuName();

}  // namespace coopdyn
