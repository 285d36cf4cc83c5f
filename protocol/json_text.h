// SPDX-License-Identifier: MIT
// Writing JSON (RFC 8259) without a library. Pure; any thread.
#pragma once

#include <string>
#include <string_view>

namespace coopdyn {

/// Appends `text` as a JSON string with its quotes. Bytes that are not UTF-8 become U+FFFD; '<', '>' and '&'
/// are escaped too, so that the string may stand inside a page.
void AppendJsonString(std::string_view text, std::string& out);
/// The same as a new string.
std::string JsonString(std::string_view text);
/// Appends `value`; null if it is not finite.
void AppendJsonNumber(double value, std::string& out);

}  // namespace coopdyn
