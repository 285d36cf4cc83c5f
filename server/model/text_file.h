// SPDX-License-Identifier: MIT
// Decodes texts from any editor: any line ends, byte order marks, UTF-8 or Latin-1. Pure except for
// ReadTextFile(), IsPipe() and ReadPipe().
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"

namespace coopdyn {

/// Maximum size of a file.
inline constexpr std::size_t kMaxTextBytes = 16u << 20;

/// `bytes` as UTF-8 without byte order mark. Treats a text that is not UTF-8 as Latin-1. Reports an error at
/// `where` if the text is UTF-16 or contains NUL.
std::optional<std::string> DecodeText(std::string_view bytes, const SourceLine& where,
                                      Diagnostics& diagnostics);

/// The decoded text of a file. Reports errors at `where` (the place that names the file).
std::optional<std::string> ReadTextFile(const std::string& file, const SourceLine& where,
                                        Diagnostics& diagnostics);

/// True if a text begins with '<', as XML does, after spaces and empty lines.
bool IsXml(std::string_view text);

/// Removes the first line from `text` and returns it. Lines end in \n, \r\n or \r.
std::string_view TakeLine(std::string_view& text);

/// The file name in messages about a text from a pipe. As an argument: standard input.
inline constexpr const char* kPipe = "-";

/// True if `name` can be read only once: "-", or a pipe such as the shell's <(COMMAND).
bool IsPipe(const std::string& name);

/// The decoded content of a pipe. Blocks until its writer ends. Reports an empty text as an error.
std::optional<std::string> ReadPipe(const std::string& name, Diagnostics& diagnostics);

}  // namespace coopdyn
