// SPDX-License-Identifier: MIT
// Texts that people wrote with any editor: any line ends, byte order marks, UTF-8 or Latin-1. Pure but for
// ReadTextFile.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"

namespace coopdyn {

/// The largest file that a reader takes.
inline constexpr std::size_t kMaxTextBytes = 16u << 20;

/// `bytes` as UTF-8 without byte order mark; what is not UTF-8 is taken for Latin-1. An error at `where` if
/// it is UTF-16 or holds NUL.
std::optional<std::string> DecodeText(std::string_view bytes, const SourceLine& where,
                                      Diagnostics& diagnostics);

/// The text of a file, decoded. Errors are reported at `where` (the place that names the file).
std::optional<std::string> ReadTextFile(const std::string& file, const SourceLine& where,
                                        Diagnostics& diagnostics);

/// Takes the first line off `text`; lines end in \n, \r\n or \r.
std::string_view TakeLine(std::string_view& text);

}  // namespace coopdyn
