// SPDX-License-Identifier: MIT
// Reads arbitrary bytes as the file of a recording, completely. Nothing may crash or hang; unreadable files
// give an error text.

// link: coopdyn_record coopdyn_state

// max_len: 32768

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "server/record/player_frames.h"
#include "server/record/run_reader.h"

namespace {

/// A file in memory if the system has such a folder.
std::string FileName() {
  const char* folder = std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp";
  return std::string(folder) + "/coopdyn_fuzz_" + std::to_string(::getpid()) + ".run";
}

struct TemporaryFile {
  const std::string name = FileName();
  ~TemporaryFile() { Remove(); }
  void Remove() const {
    for (const char* end : {"", "-wal", "-shm", "-journal"}) ::unlink((name + end).c_str());
  }
};

/// Robot models are slow to read: most inputs have the same as the previous one.
void LoadScenario(coopdyn::RunReader& reader) {
  static std::string known_text;
  static std::shared_ptr<const coopdyn::Scenario> known;
  std::string text = reader.header().scenario_text;
  for (const coopdyn::SourceText& source : reader.header().sources) text += source.name + source.text;
  if (known != nullptr && text == known_text) {
    reader.UseScenario(known);
    return;
  }
  coopdyn::Diagnostics diagnostics;
  const auto scenario = reader.LoadScenario(coopdyn::SearchPath(), diagnostics);
  if (scenario == nullptr) return;
  known = scenario;
  known_text = text;
}

void Require(bool fine) {
  if (!fine) std::abort();
}

void ReadAll(coopdyn::RunReader& reader) {
  const coopdyn::RunExtent extent = reader.extent();
  const std::uint64_t last = extent.first + std::min<std::uint64_t>(extent.last - extent.first, 20);
  for (const bool inputs_only : {true, false}) {
    const bool read =
        reader.ForEach(extent.first, last, inputs_only, [](const coopdyn::RecordedStep&) { return true; });
    Require(read || !reader.error().empty());
  }
  coopdyn::PlayFrames frames(reader);
  for (std::uint64_t step = extent.first; step <= last; ++step) {
    const auto read = reader.Read(step);
    if (!read || read->bodies.empty()) continue;
    const auto frame = frames.Make(step);
    Require(frame != nullptr || !reader.error().empty());
  }
  reader.StepAt(extent.end / 2, true);
  reader.NextShown(extent.first, false);
  Require(reader.Keyframe(last) != nullptr || !reader.error().empty());
  reader.Keyframes();
  reader.Inputs(0, last);
  reader.Events();
  Require(reader.Contents() || !reader.error().empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const TemporaryFile file;
  file.Remove();
  std::ofstream(file.name, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  std::string error;
  const auto reader = coopdyn::RunReader::Open(file.name, error);
  Require((reader == nullptr) != error.empty());
  if (reader == nullptr) return 0;
  LoadScenario(*reader);
  ReadAll(*reader);
  return 0;
}
