// SPDX-License-Identifier: MIT
// The commands print only with these functions: results to stdout, all else to stderr. They make texts of
// files, peers and libraries printable, so none can control the terminal or break a line. Main thread.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "server/base/printable.h"

namespace coopdyn {

/// Prints text of several lines, each ending with '\n'.
inline void PrintLines(std::string_view text, std::FILE* to = stdout) {
  const std::string shown = PrintableLines(text);
  std::fwrite(shown.data(), 1, shown.size(), to);
  std::fflush(to);
}
inline void PrintErrorLines(std::string_view text) {
  PrintLines(text, stderr);
}

/// A value for fmt: makes texts printable on one line, and cuts very long ones.
template <typename T>
decltype(auto) Shown(const T& value) {
  if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    return Printable(std::string_view(value));
  } else {
    return (value);
  }
}
template <typename T>
using ShownAs = decltype(Shown(std::declval<const T&>()));

/// Like fmt::print(), with Shown() values.
template <typename... Values>
void Print(fmt::format_string<ShownAs<Values>...> format, const Values&... values) {
  PrintLines(fmt::format(format, Shown(values)...));
}
template <typename... Values>
void PrintError(fmt::format_string<ShownAs<Values>...> format, const Values&... values) {
  PrintErrorLines(fmt::format(format, Shown(values)...));
}

}  // namespace coopdyn
