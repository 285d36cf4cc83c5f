// SPDX-License-Identifier: MIT
// What a recording says about the run as a whole: table `meta` and the texts it carries.
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

/// A loaded controller of the run.
struct PluginHash {
  std::string name;  // as the scenario has it; of a library its file's
  std::string hash;  // FileHash() when the recording began
};

struct RunHeader {
  std::string version;  // of coopdyn
  std::string build;    // BuildId(): the same of this and of `libraries`, the same bits
  std::string cpu;      // model name
  std::string started;  // UTC, ISO 8601
  std::string command;  // line; for people
  std::string scenario_name, scenario_file;
  std::string scenario_text;
  std::string scores;                      // "reach, distance m": names and units, as in table `step`
  std::vector<SourceText> sources;         // worlds and robot models that it names
  std::uint64_t scenario_seed = 1;         // with which the texts were read (places of swarms)
  std::uint64_t seed = 1;                  // of noise and solver
  Mode mode = Mode::kRealtime;             // at the start
  Nanoseconds step_length = kDefaultStep;  // at the start
  std::optional<int> substeps;
  RecordWhat what;
  Nanoseconds pose_every = 0;  // 0: each step
  std::vector<PluginHash> controllers;
  std::vector<PluginHash> libraries;  // LibrariesHere()
};

/// 16 hex digits of this program's file, as it was started.
std::string BuildId();
/// The libraries of others in this process that compute something of a run's hash, by their files.
std::vector<PluginHash> LibrariesHere();
/// XXH3-64 of the bytes of `file`, 16 hex digits; empty if it cannot be read.
std::string FileHash(const std::string& file);
/// What tells this run's inputs from another's: "build", "scenario", "robot coopbot", "controller diffuse", …
/// and 16 hex digits of each.
std::map<std::string, std::string> DigestsOf(const RunHeader& header);
/// The processor's model name, as the system tells it.
std::string CpuName();

}  // namespace coopdyn
