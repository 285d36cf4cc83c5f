// SPDX-License-Identifier: MIT
// The .scenario reader, as for texts received by socket: any bytes give errors or a finite scenario. Run it
// from the root of the sources so that it finds robots/coopbot; elsewhere every robot type is unknown.

// link: coopdyn_model coopdyn_geometry coopdyn_base

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "server/model/readers.h"
#include "server/model/scenario.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static coopdyn::RobotLibrary robots(coopdyn::SearchPath{{"."}});
  coopdyn::Diagnostics diagnostics;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto scenario = coopdyn::ReadScenario(text, "", robots, true, diagnostics);
  if ((scenario == nullptr) != diagnostics.has_errors()) std::abort();
  if (scenario == nullptr) return 0;
  for (const coopdyn::RobotEntry& robot : scenario->robots) {
    if (!robot.X_WR.p.allFinite() || !robot.X_WR.q.coeffs().allFinite()) std::abort();
  }
  return coopdyn::Summary(*scenario).empty() ? 1 : 0;
}
