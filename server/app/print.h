// SPDX-License-Identifier: MIT
// All that the commands print goes through here, to stdout what was asked for, to stderr the rest: no text of
// a file, a peer or a library can steer a terminal, and what stands in a line stays in it. Main thread.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "server/base/printable.h"

namespace coopdyn {

/// Texts of several lines, each ended by '\n'.
inline void PrintLines(std::string_view text, std::FILE* to = stdout) {
  const std::string shown = PrintableLines(text);
  std::fwrite(shown.data(), 1, shown.size(), to);
  std::fflush(to);
}
inline void PrintErrorLines(std::string_view text) {
  PrintLines(text, stderr);
}

/// A value for fmt: texts become printable, in one line, and are cut if they are very long.
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

/// As fmt::print(), with Shown() values.
template <typename... Values>
void Print(fmt::format_string<ShownAs<Values>...> format, const Values&... values) {
  PrintLines(fmt::format(format, Shown(values)...));
}
template <typename... Values>
void PrintError(fmt::format_string<ShownAs<Values>...> format, const Values&... values) {
  PrintErrorLines(fmt::format(format, Shown(values)...));
}

}  // namespace coopdyn
