// SPDX-License-Identifier: MIT
// Names of recordings: as clients write them (bare file names, so that only the folder can be reached), and
// as they appear in URLs. Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace coopdyn {

inline constexpr std::string_view kRunExtension = ".run";
inline constexpr std::size_t kMaxRunName = 200;  // bytes, without .run; -2 and so on make it longer

/// `name` with .run appended unless it already ends so.
std::string WithRunExtension(const std::string& name);
/// True if clients may list and request a recording of that name, whatever its extension.
bool IsRunName(std::string_view name);
/// Why no recording can be started under that name; empty if one can.
std::string RunNameObjection(std::string_view name);
/// The URL of recording `name` on the page at `page`, which ends with a slash; without blanks. Empty if there
/// is no page, or it does not serve such a file.
std::string RunUrl(const std::string& page, const std::string& name);

/// `A b` as `A%20b`: encodes all but RFC 3986's unreserved characters, byte by byte.
std::string PercentEncode(std::string_view text);
/// The reverse; nullopt if malformed.
std::optional<std::string> PercentDecode(std::string_view text);

}  // namespace coopdyn
