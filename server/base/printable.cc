// SPDX-License-Identifier: MIT
#include "server/base/printable.h"

#include <algorithm>

namespace coopdyn {

std::string Printable(std::string_view text) {
  constexpr char kFirstPrintable = ' ', kDelete = '\x7f';
  const auto is_control = [](char c) { return (c >= 0 && c < kFirstPrintable) || c == kDelete; };
  std::string shown(text);
  std::replace_if(shown.begin(), shown.end(), is_control, '?');
  return shown;
}

}  // namespace coopdyn
