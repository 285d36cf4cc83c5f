// SPDX-License-Identifier: MIT
#include "server/devices/token_guard.h"

#include <cstddef>

namespace coopdyn {

bool TokenGuard::Matches(std::string_view given) const {
  if (token_.empty()) return false;
  unsigned difference = token_.size() == given.size() ? 0 : 1;
  for (std::size_t i = 0; i < given.size(); ++i) {
    difference |=
        static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(token_[i % token_.size()]);
  }
  return difference == 0;
}

TokenVerdict TokenGuard::Judge(std::string_view given, const std::string& peer, Nanoseconds now) const {
  const bool right = Matches(given);
  if (wrong_ != nullptr) return wrong_->Judge(right, peer, now);
  return right ? TokenVerdict::kRight : TokenVerdict::kWrong;
}

}  // namespace coopdyn
