// SPDX-License-Identifier: MIT
// Names of recordings as clients may give them, bare, so that nothing but the folder can be reached; and as
// they stand in addresses. Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace coopdyn {

inline constexpr std::string_view kRunExtension = ".run";
inline constexpr std::size_t kMaxRunName = 200;  // bytes, without .run; -2 and so on make it longer

/// `name`, with .run unless it ends so.
std::string WithRunExtension(const std::string& name);
/// A recording of that name, whatever its ending, can be told of and asked for.
bool IsRunName(std::string_view name);
/// Why no recording can be begun under that name; empty if one can.
std::string RunNameObjection(std::string_view name);
/// Where a page at `page`, which ends with a slash, has the recording `name`: without blanks. Empty: there is
/// no page, or it serves no file of that name.
std::string RunUrl(const std::string& page, const std::string& name);

/// `A b` as `A%20b`: all but RFC 3986's unreserved characters, byte by byte.
std::string PercentEncode(std::string_view text);
/// The reverse; nothing if it is badly formed.
std::optional<std::string> PercentDecode(std::string_view text);

}  // namespace coopdyn
