// SPDX-License-Identifier: MIT
// The codecs: pure incremental functions, bytes in; a message, "need more" or "bad" out. No sockets, no
// locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/command_table.h"
#include "protocol/message.h"

namespace coopdyn {

inline constexpr std::string_view kBinaryMagic = "CDS1";
inline constexpr std::size_t kMaxRequestBytes = std::size_t{1} << 20;  // 1 MiB
inline constexpr std::size_t kMaxTextsBytes = std::size_t{16} << 20;   // scenario texts and uploads
inline constexpr std::size_t kMaxReplyBytes = std::size_t{64} << 20;

/// What a decoder made of the bytes so far.
enum class DecodeStatus {
  kNeedMore,  // nothing consumed that matters; call again with more bytes appended
  kMessage,   // `message` holds one; `consumed` bytes are done with
  kBad,       // `message` is the error reply to send; the connection may go on
  kFatal,     // `message` is the error reply to send before closing
  kNothing,   // `consumed` bytes are done with, nothing to answer (comment, empty line)
  kHelp,      // text only: print help as # lines (`help`, or the first empty line)
  kVerbose,   // text only: turn on verbose replies
  kLeave,     // text only: close the connection (`exit`, and `quit` and `bye` where they are no commands)
};

struct Decoded {
  DecodeStatus status = DecodeStatus::kNeedMore;
  std::size_t consumed = 0;
  Message message;
};

// --- binary
// -----------------------------------------------------------------------------------------------------
/// Decodes the first frame of `bytes` (after the magic). `max_bytes` limits `size`.
/// Once the header says a scenario text (command 108) follows, kMaxTextsBytes applies instead.
/// Bad frames: size < 20 or counts that do not add up (error 7, command -2) and too large ones (error 8,
/// command -2) are kFatal as soon as the bytes that say so are there; a text that is not clean UTF-8 (error
/// 7) is kBad.
Decoded DecodeBinary(std::string_view bytes, std::size_t max_bytes = kMaxRequestBytes);
/// Appends the frame of `message` to `out`.
void EncodeBinary(const Message& message, std::string& out);

// --- text
// -------------------------------------------------------------------------------------------------------
/// Decodes the first line of `bytes`, which ends with LF or CR LF. `first_line`: no line came before on this
/// connection (an empty first line asks for help). `table` gives named lines their meaning.
/// Telnet negotiation (IAC …) is part of the line it stands in and is skipped there; a LF always ends the
/// line. An unreadable line gives kBad with error 7 and command -2, an unknown word error 1 and command -2; a
/// known word with wrong values gives what CheckRequest says, with its own command. More than 1 MiB without
/// LF: kFatal, error 8.
Decoded DecodeText(std::string_view bytes, const CommandTable& table, bool first_line);
/// Appends the full form of `message` and '\n' to `out`. Doubles print shortest and read back the same.
/// Control characters that the text form has no escape for (a terminal would obey them) become '?'.
void EncodeText(const Message& message, std::string& out);
/// Appends one `#` line that names the values and units of `reply` by the spec of its command.
void EncodeVerbose(const Message& reply, const CommandTable& table, std::string& out);
/// The `#` lines that `help` prints.
std::string HelpText(const CommandTable& table);
/// Appends `value` so that reading gives the same double; always with '.', 'e', "inf" or "nan". The digits
/// are those of Python's repr.
void AppendDouble(double value, std::string& out);

// --- the first bytes
// ---------------------------------------------------------------------------------------------
/// What the first bytes of a client choose.
enum class FirstBytes {
  kUndecided,   // need more bytes
  kBinary,      // "CDS1": 4 bytes to skip
  kWrongMagic,  // "CDS" and something else
  kHttp,        // METHOD SP … HTTP/: answer 400 and close
  kText,
};
/// Bytes after which SniffEncoding never answers kUndecided.
inline constexpr std::size_t kMaxSniffBytes = 8192;
FirstBytes SniffEncoding(std::string_view bytes);

/// How many characters UTF-8 `text` has.
std::size_t CharacterCount(std::string_view text);
/// True if `text` is well-formed UTF-8 (RFC 3629) without NUL.
bool IsCleanUtf8(std::string_view text);

}  // namespace coopdyn
