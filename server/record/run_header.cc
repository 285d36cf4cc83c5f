// SPDX-License-Identifier: MIT
#include "server/record/run_header.h"

#define XXH_INLINE_ALL
#include <link.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

namespace coopdyn {

namespace {

/// Adds the bytes of `file` to `state`; false if it cannot be read.
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

/// Callback of dl_iterate_phdr(): adds the library to `data`, a std::vector<PluginHash>, if its computations
/// matter.
int AddLibrary(dl_phdr_info* info, std::size_t /*size*/, void* data) {
  constexpr std::array<std::string_view, 5> kComputing = {"libode.", "libccd.", "libsleef.", "libsdformat",
                                                          "libignition-math"};
  std::error_code error;
  const std::filesystem::path file = std::filesystem::canonical(info->dlpi_name, error);
  const std::string name = file.filename().string();
  const auto starts = [&name](std::string_view begin) { return name.starts_with(begin); };
  if (!error && std::ranges::any_of(kComputing, starts))
    static_cast<std::vector<PluginHash>*>(data)->push_back({name, FileHash(file.string())});
  return 0;
}

}  // namespace

std::string BuildId() {
  return FileHash("/proc/self/exe");  // the running one, even if its file was replaced
}

std::vector<PluginHash> LibrariesHere() {
  std::vector<PluginHash> found;
  dl_iterate_phdr(AddLibrary, &found);
  std::ranges::sort(found, {}, &PluginHash::name);
  return found;
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
  for (const PluginHash& one : header.libraries) digests["library " + one.name] = one.hash;
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
