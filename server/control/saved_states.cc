// SPDX-License-Identifier: MIT
#include "server/control/saved_states.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "protocol/ascii.h"

namespace coopdyn {

namespace {

bool IsGoodName(const std::string& name) {
  const auto is_letter = [](char c) { return IsLower(c) || IsUpper(c); };
  if (name.empty() || name.size() > SavedStates::kMaxName || !is_letter(name.front())) return false;
  return std::all_of(name.begin(), name.end(),
                     [&is_letter](char c) { return is_letter(c) || IsDigit(c) || c == '_' || c == '-'; });
}

}  // namespace

std::string SavedStates::Objection(const std::string& name) const {
  if (name == kStart) return "start is where the run began: save under another name";
  if (!IsGoodName(name)) {
    return fmt::format(
        "the name of a saved state is a letter, then letters, digits, _ and -, at most {}: save before_turn",
        kMaxName);
  }
  if (states_.size() >= kMaxStates && Find(name) == nullptr) {
    return fmt::format("{} states are saved, more are not kept: save under the name of one of them",
                       kMaxStates);
  }
  return {};
}

void SavedStates::Keep(const std::string& name, SavedStatePtr state) {
  for (auto& [known, kept] : states_) {
    if (known == name) {
      kept = std::move(state);
      return;
    }
  }
  states_.emplace_back(name, std::move(state));
}

SavedStatePtr SavedStates::Find(std::string_view name) const {
  for (const auto& [known, kept] : states_) {
    if (known == name) return kept;
  }
  return nullptr;
}

std::string SavedStates::Names() const {
  std::string names(kStart);
  for (const auto& [name, state] : states_) names += " " + name;
  return names;
}

}  // namespace coopdyn
