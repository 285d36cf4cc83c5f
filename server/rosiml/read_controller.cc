// SPDX-License-Identifier: MIT
// Reads <controller> of the public grammar as a line that configures a loaded controller.
#include <algorithm>
#include <cmath>
#include <set>

#include "server/base/printable.h"
#include "server/rosiml/lines.h"
#include "server/rosiml/reader.h"

namespace coopdyn::rosiml {

namespace {

/// `name` as a scenario's option name: lower-case letters, digits and _; empty if it would not start with a
/// letter.
std::string OptionName(const std::string& name) {
  std::string option;
  for (const char c : name) {
    const char small = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const bool is_plain = (small >= 'a' && small <= 'z') || (small >= '0' && small <= '9');
    option += is_plain ? small : '_';
  }
  constexpr std::size_t kMost = 63;
  const bool fits =
      !option.empty() && option.front() >= 'a' && option.front() <= 'z' && option.size() <= kMost;
  return fits ? option : "";
}

/// A number, or 1 and 0 for `true` and `false`.
std::optional<double> OptionValue(const std::string& text) {
  if (text == "true") return 1;
  if (text == "false") return 0;
  return ParseNumber(text);
}

}  // namespace

bool Reader::HasTooManyParameters(const Element& controller) {
  constexpr int kMost = 1000;
  int count = 0;
  ForEachChild(controller, [&count](const Element&) { ++count; });
  if (count <= kMost) return false;
  Error(controller, "a controller has at most " + std::to_string(kMost) + " parameters");
  return true;
}

std::string Reader::LoadedController(const Element& element, bool has_motors,
                                     const HasController& has_controller) {
  const std::string module = Text(element, "module");
  if (module.empty() || module == "TCPIP") return {};
  std::string line;
  for (const std::string& name : {module, "libYarsController" + module}) {
    if (has_controller && module == Simple(module, 63) && has_controller(name)) {
      line = name;
      break;
    }
  }
  if (line.empty()) {
    Warn(element, "the controller '" + Printable(module) + "' of YARS is not loaded, as there is no " +
                      Printable(module) +
                      ".so beside the experiment or on the search path: a client drives the robot, or one of "
                      "coopdyn's controllers by --set ROBOT_1.controller=NAME");
    return {};
  }
  if (!has_motors) {
    Warn(element, "the controller '" + Printable(module) + "' is not loaded: the robot has no motors");
    return {};
  }
  if (HasTooManyParameters(element)) return line;
  std::set<std::string> given;
  ForEachChild(element, [&](const Element& parameter) {
    const std::string name = Text(parameter, "name"), option = OptionName(name);
    const std::optional<double> value = OptionValue(Text(parameter, "value"));
    if (option.empty() || !value) {
      Warn(parameter, "the parameter '" + Printable(name) +
                          "' is left out: its name begins with a letter, and its value is a number, true or "
                          "false");
    } else if (!given.insert(option).second) {
      Warn(parameter, "the parameter '" + Printable(name) + "' is left out: there is one before it");
    } else {
      line += " " + option + "=" + Exact(*value);
    }
  });
  return line;
}

int Reader::PortOf(const Element& controller) {
  constexpr double kMost = 65535;
  int port = 0;
  if (Text(controller, "module") != "TCPIP") return port;
  ForEachChild(controller, [&](const Element& parameter) {
    if (Text(parameter, "name") != "port") return;
    const std::string text = Text(parameter, "value");
    const std::optional<double> value = ParseNumber(text);
    if (!value || *value < 1 || *value > kMost || *value != std::floor(*value))
      return Error(parameter,
                   "the port must be a whole number from 1 to 65535, not '" + Printable(text) + "'");
    port = static_cast<int>(*value);
  });
  return port;
}

}  // namespace coopdyn::rosiml
