// SPDX-License-Identifier: MIT
#include "server/control/run_names.h"

#include <spdlog/fmt/fmt.h>

namespace coopdyn {

std::string WithRunExtension(const std::string& name) {
  return name.ends_with(kRunExtension) ? name : name + std::string(kRunExtension);
}

std::string RunNameObjection(const std::string& name) {
  constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";
  const std::size_t length = name.size() - kRunExtension.size();
  const bool good = length >= 1 && length <= kMaxRunName && name.front() != '.' &&
                    name.find_first_not_of(kAllowed) == std::string::npos;
  if (good) return {};
  return fmt::format(
      "the name of a recording is letters, digits, _, - and ., at most {}, and does not begin with a '.': "
      "start "
      "lesson1",
      kMaxRunName);
}

}  // namespace coopdyn
