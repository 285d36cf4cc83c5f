// SPDX-License-Identifier: MIT
// Splitting, comparing and correcting words of user files. Pure; any thread; locale-independent.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace coopdyn {

/// ASCII letters to lower case; other bytes unchanged.
std::string ToLower(std::string_view text);
/// ASCII letters to upper case; other bytes unchanged.
std::string ToUpper(std::string_view text);
/// `text` without spaces and tabs at both ends.
std::string_view Trim(std::string_view text);
/// The words between spaces and tabs.
std::vector<std::string> SplitWords(std::string_view text);
/// `a, b and c`, each in single quotes if `quoted`.
std::string JoinNames(std::span<const std::string> names, bool quoted = false);

/// The name of the root element of an XML `text`; empty if it has none.
std::string_view RootElement(std::string_view text);

/// The candidate nearest to `word` if it is close enough to be a typo; else empty. Case-insensitive.
std::string Nearest(std::string_view word, std::span<const std::string> candidates);
/// `; did you mean 'x'?`, or `; known are a, b and c` if nothing is near.
std::string DidYouMean(std::string_view word, std::span<const std::string> candidates);

}  // namespace coopdyn
