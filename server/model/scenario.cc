// SPDX-License-Identifier: MIT
#include "server/model/scenario.h"

#include <algorithm>

#include "server/model/values.h"

namespace coopdyn {

std::vector<std::string> RobotEntry::awaited_modules() const {
  std::vector<std::string> awaited = model->actuator_modules();
  if (waits_for.empty()) return awaited;
  std::erase_if(awaited, [this](const std::string& name) {
    return std::find(waits_for.begin(), waits_for.end(), name) == waits_for.end();
  });
  return awaited;
}

const char* ToString(Mode mode) {
  switch (mode) {
    case Mode::kRealtime:
      return "realtime";
    case Mode::kLockstep:
      return "lockstep";
    case Mode::kFree:
      return "free";
  }
  return "realtime";
}

std::optional<Mode> ParseMode(const std::string& word) {
  const std::string lower = ToLower(word);
  for (const Mode mode : {Mode::kRealtime, Mode::kLockstep, Mode::kFree}) {
    if (lower == ToString(mode)) return mode;
  }
  return std::nullopt;
}

const char* ToString(LossPolicy policy) {
  switch (policy) {
    case LossPolicy::kWait:
      return "wait";
    case LossPolicy::kHold:
      return "hold";
    case LossPolicy::kStop:
      return "stop";
    case LossPolicy::kDrop:
      return "drop";
  }
  return "wait";
}

const char* ToString(Fidelity fidelity) {
  switch (fidelity) {
    case Fidelity::kFull:
      return "full";
    case Fidelity::kRolling:
      return "rolling";
    case Fidelity::kPlanar:
      return "planar";
  }
  return "full";
}

std::optional<Fidelity> ParseFidelity(const std::string& word) {
  const std::string lower = ToLower(word);
  for (const Fidelity fidelity : {Fidelity::kFull, Fidelity::kRolling, Fidelity::kPlanar}) {
    if (lower == ToString(fidelity)) return fidelity;
  }
  return std::nullopt;
}

}  // namespace coopdyn
