// SPDX-License-Identifier: MIT
// YARS experiments: any bytes give errors, or texts with the line number of each line.

// link: coopdyn_rosiml coopdyn_geometry coopdyn_base
// max_len: 16384

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "server/rosiml/translate.h"

namespace {

void CheckLines(const coopdyn::rosiml::MadeText& made) {
  const auto ends = std::count(made.text.begin(), made.text.end(), '\n');
  if (static_cast<std::size_t>(ends) != made.lines.size()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  coopdyn::Diagnostics diagnostics;
  const auto made = coopdyn::rosiml::Translate(text, "fuzz.xml", "fuzz.", diagnostics);
  if (made.has_value() == diagnostics.has_errors()) std::abort();
  if (!made) return 0;
  CheckLines(made->scenario);
  for (const coopdyn::rosiml::MadeModel& model : made->models) CheckLines(model.sdf);
  return 0;
}
