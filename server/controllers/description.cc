// SPDX-License-Identifier: MIT
#include "server/controllers/description.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/model/values.h"

namespace coopdyn {

std::vector<std::string> ControllerDescription::Faults(const ControllerChoice& choice) const {
  std::vector<std::string> names, faults;
  for (const ControllerOption& option : options) names.push_back(option.name);
  for (const auto& [name, value] : choice.options) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      faults.push_back(fmt::format("controller {} has no option '{}'{}", choice.name, name,
                                   names.empty() ? ": it takes none" : DidYouMean(name, names)));
      continue;
    }
    const ControllerOption& option = options[static_cast<std::size_t>(found - names.begin())];
    // Not `value < min || …`: that would let nan pass.
    if (value >= option.min && value <= option.max) continue;
    faults.push_back(
        fmt::format("controller {}: {} must be from {} to {}, not {}; for example: controller {} {}={}{}",
                    choice.name, name, option.min, option.max, value, choice.name, name, option.value,
                    option.help.empty() ? "" : " (" + option.help + ")"));
  }
  return faults;
}

std::vector<double> ControllerDescription::Values(const ControllerChoice& choice) const {
  std::vector<double> values;
  for (const ControllerOption& option : options) {
    const auto given = std::find_if(choice.options.begin(), choice.options.end(),
                                    [&option](const auto& pair) { return pair.first == option.name; });
    values.push_back(given == choice.options.end() ? option.value : given->second);
  }
  return values;
}

}  // namespace coopdyn
