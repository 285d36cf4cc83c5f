// SPDX-License-Identifier: MIT
#include "server/record/run_header.h"

#define XXH_INLINE_ALL
#include <link.h>
#include <xxhash.h>

#include <array>
#include <cstddef>
#include <fstream>
#include <string_view>

namespace coopdyn {

namespace {

/// False if it cannot be read.
bool AddFile(const std::string& file, XXH3_state_t& state) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return false;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (stream) {
    stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    XXH3_64bits_update(&state, buffer.data(), static_cast<std::size_t>(stream.gcount()));
  }
  return stream.eof();
}

/// dl_iterate_phdr()'s callback: stops at the physics library, whose file goes to `data`, a std::string.
int FindPhysics(dl_phdr_info* info, std::size_t /*size*/, void* data) {
  const std::string_view file = info->dlpi_name;
  if (file.substr(file.rfind('/') + 1).rfind("libode.so", 0) != 0) return 0;
  *static_cast<std::string*>(data) = file;
  return 1;
}

}  // namespace

std::string BuildId() {
  // The program's file is read as it was started, also if a newer one has taken its name since.
  std::string physics;
  dl_iterate_phdr(FindPhysics, &physics);
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  AddFile("/proc/self/exe", state);
  if (!physics.empty()) AddFile(physics, state);
  return HashText(XXH3_64bits_digest(&state));
}

std::string FileHash(const std::string& file) {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  return AddFile(file, state) ? HashText(XXH3_64bits_digest(&state)) : "";
}

std::map<std::string, std::string> DigestsOf(const RunHeader& header) {
  const auto digest = [](const std::string& text) { return HashText(XXH3_64bits(text.data(), text.size())); };
  std::map<std::string, std::string> digests{{"build", header.build},
                                             {"scenario", digest(header.scenario_text)}};
  for (const SourceText& source : header.sources) {
    digests[source.kind + " " + source.name] = digest(source.text);
  }
  for (const PluginHash& one : header.controllers) digests["controller " + one.name] = one.hash;
  return digests;
}

std::string CpuName() {
  std::ifstream stream("/proc/cpuinfo");
  std::string line;
  while (std::getline(stream, line)) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t colon = line.find(':');
    const std::size_t start = colon == std::string::npos ? colon : line.find_first_not_of(" \t", colon + 1);
    if (start != std::string::npos) return line.substr(start);
  }
  return "unknown";
}

}  // namespace coopdyn
