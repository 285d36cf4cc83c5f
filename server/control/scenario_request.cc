// SPDX-License-Identifier: MIT
#include "server/control/scenario_request.h"

#include <exception>
#include <utility>

#include "server/base/printable.h"
#include "server/model/text_file.h"

namespace coopdyn {

namespace {

constexpr std::size_t kMaxNames = 40;

ScenarioRead NoScenario(Error error, std::string text) {
  return {nullptr, error, std::move(text)};
}

ScenarioRead Finish(std::shared_ptr<const Scenario> scenario, const Diagnostics& diagnostics) {
  std::string text = diagnostics.ToString();
  if (!text.empty()) text.pop_back();
  if (scenario == nullptr || diagnostics.has_errors()) return NoScenario(Error::kMalformed, std::move(text));
  return {std::move(scenario), Error::kOk, std::move(text)};
}

std::string KnownNames(const RobotLibrary& robots) {
  std::string list;
  std::size_t count = 0;
  for (const std::string& name : robots.path().ScenarioNames()) {
    if (++count > kMaxNames) return list + ", …";
    list += (list.empty() ? "" : ", ") + name;
  }
  return list.empty() ? "there are none on the search path" : "there are " + list;
}

/// What `read` gives; what it throws is an error.
template <typename Function>
ScenarioRead Guarded(Function read) {
  try {
    return read();
  } catch (const std::exception& exception) {  // e.g. no more memory
    return NoScenario(Error::kInternal, std::string("the scenario cannot be read: ") + exception.what());
  }
}

ScenarioRead ReadRequested(const std::string& text, RobotLibrary& robots, std::optional<std::uint64_t> seed) {
  Diagnostics diagnostics;
  if (text.find_first_of("\n[") != std::string::npos) {
    return Finish(ReadScenario(text, "(text)", robots, true, diagnostics, seed), diagnostics);
  }
  if (!IsBareName(text)) {
    return NoScenario(Error::kNoSuchName,
                      "load_scenario takes a name on the daemon's search path, without folders, or the "
                      "text of the file; " +
                          KnownNames(robots));
  }
  if (!robots.path().FindScenario(text)) {
    return NoScenario(Error::kNoSuchName,
                      "there is no scenario " + Printable(text) + ": " + KnownNames(robots));
  }
  return Finish(LoadScenario(text, robots, diagnostics, false, seed), diagnostics);
}

ScenarioRead ReadAgain(const Scenario& current, RobotLibrary& robots, std::optional<std::uint64_t> seed) {
  if (current.file.empty() || current.file == kPipe) {
    return NoScenario(Error::kNotPossible,
                      "this scenario came as a text, there is no file to read again: upload it again, or "
                      "coopdyn load FILE");
  }
  Diagnostics diagnostics;
  return Finish(LoadScenario(current.file, robots, diagnostics, false, seed), diagnostics);
}

}  // namespace

ScenarioRead ReadRequestedScenario(const std::string& text, RobotLibrary& robots,
                                   std::optional<std::uint64_t> seed) {
  return Guarded([&] { return ReadRequested(text, robots, seed); });
}

ScenarioRead ReadScenarioAgain(const Scenario& current, RobotLibrary& robots,
                               std::optional<std::uint64_t> seed) {
  return Guarded([&] { return ReadAgain(current, robots, seed); });
}

}  // namespace coopdyn
