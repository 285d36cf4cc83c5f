// SPDX-License-Identifier: MIT
// The robot model reader: any bytes give errors or a model with finite masses and poses.

// link: coopdyn_model coopdyn_geometry coopdyn_base

#include <stdlib.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "server/model/readers.h"

namespace {

/// A private file of this process, in memory if possible.
std::filesystem::path ModelFile() {
  std::error_code code;
  const bool shm = std::filesystem::is_directory("/dev/shm", code);
  std::string pattern = std::string(shm ? "/dev/shm" : "/tmp") + "/coopdyn-sdf-fuzz-XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr) std::abort();
  return std::filesystem::path(pattern) / "model.sdf";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path file = ModelFile();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  coopdyn::Diagnostics diagnostics;
  const auto model = coopdyn::ReadRobotModel(file, coopdyn::SearchPath{}, diagnostics);
  if ((model == nullptr) != diagnostics.has_errors()) std::abort();
  if (model == nullptr) return 0;
  for (const coopdyn::LinkModel& link : model->links) {
    if (!std::isfinite(link.mass_kg) || !link.X_RL.p.allFinite() || !link.inertia_kg_m2.allFinite())
      std::abort();
  }
  return 0;
}
