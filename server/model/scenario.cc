// SPDX-License-Identifier: MIT
#include "server/model/scenario.h"

#include "server/model/values.h"

namespace coopdyn {

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
