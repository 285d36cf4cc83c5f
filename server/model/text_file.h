// SPDX-License-Identifier: MIT
// Texts that people wrote with any editor: any line ends, byte order marks, UTF-8 or Latin-1. Pure but for
// ReadTextFile and the two of pipes.
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

/// Whether a text begins with '<', as XML does, behind spaces and empty lines.
bool IsXml(std::string_view text);

/// Takes the first line off `text`; lines end in \n, \r\n or \r.
std::string_view TakeLine(std::string_view& text);

/// How messages call a text that came through a pipe; as a name, standard input.
inline constexpr const char* kPipe = "-";

/// Whether `name` is a text that comes once and lies nowhere: "-", or a pipe such as the shell's <(COMMAND).
bool IsPipe(const std::string& name);

/// All that comes through a pipe, decoded; waits for its writer. Nothing is an error.
std::optional<std::string> ReadPipe(const std::string& name, Diagnostics& diagnostics);

}  // namespace coopdyn
