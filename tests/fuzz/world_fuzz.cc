// SPDX-License-Identifier: MIT
// The .world reader: any bytes give diagnostics or a finite world.

// link: coopdyn_model coopdyn_geometry coopdyn_base

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "server/model/readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  coopdyn::Diagnostics diagnostics;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const coopdyn::WorldModel world = coopdyn::ReadWorld(text, "fuzz.world", diagnostics);
  for (const coopdyn::WorldObject& object : world.objects) {
    const bool finite = object.X_WO.p.allFinite() && object.X_WO.q.coeffs().allFinite() &&
                        std::isfinite(object.mass_kg) && coopdyn::Volume(object.shape) > 0;
    if (!finite) std::abort();
  }
  return 0;
}
