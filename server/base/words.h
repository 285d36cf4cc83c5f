// SPDX-License-Identifier: MIT
// Words as people write them in files. Pure functions; any thread; independent of the locale.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace coopdyn {

/// ASCII letters to lower case; other bytes as they are.
std::string ToLower(std::string_view text);
/// And to upper case.
std::string ToUpper(std::string_view text);
/// Without spaces and tabs at both ends.
std::string_view Trim(std::string_view text);
/// The words between spaces and tabs.
std::vector<std::string> SplitWords(std::string_view text);
/// `a, b and c`, each in single quotes if `quoted`.
std::string JoinNames(std::span<const std::string> names, bool quoted = false);

/// The name of the root element of an XML `text`; empty if it has none.
std::string_view RootElement(std::string_view text);

/// The candidate nearest to `word` if it is near enough to be a slip; empty otherwise. Case-insensitive.
std::string Nearest(std::string_view word, std::span<const std::string> candidates);
/// `; did you mean 'x'?`, or `; known are a, b and c` if nothing is near.
std::string DidYouMean(std::string_view word, std::span<const std::string> candidates);

}  // namespace coopdyn
