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

/// The result of decoding the bytes so far.
enum class DecodeStatus {
  kNeedMore,  // incomplete: call again with more bytes appended
  kMessage,   // `message` is complete; drop `consumed` bytes
  kBad,       // `message` is the error reply to send; the connection stays usable
  kFatal,     // `message` is the error reply to send before closing
  kNothing,   // drop `consumed` bytes without a reply (comment, empty line)
  kHelp,      // text only: print help as # lines (`help`, or the first empty line)
  kVerbose,   // text only: turn on verbose replies
  kLeave,  // text only: close the connection (`exit`; `quit` and `bye` unless the module has such a command)
};

struct Decoded {
  DecodeStatus status = DecodeStatus::kNeedMore;
  std::size_t consumed = 0;
  Message message;
};

// --- binary
// -----------------------------------------------------------------------------------------------------
/// Decodes the first frame of `bytes` (after the magic). `max_bytes` limits `size`.
/// Once the header announces a scenario text (command 108), kMaxTextsBytes applies instead.
/// Frames with size < 20 or inconsistent counts (error 7, command -2) and oversized frames (error 8, command
/// -2) are kFatal as soon as the offending bytes have arrived; a text that is not clean UTF-8 (error 7) is
/// kBad.
Decoded DecodeBinary(std::string_view bytes, std::size_t max_bytes = kMaxRequestBytes);
/// Appends the frame of `message` to `out`.
void EncodeBinary(const Message& message, std::string& out);

// --- text
// -------------------------------------------------------------------------------------------------------
/// Decodes the first line of `bytes`, which ends with LF or CR LF. `first_line`: this is the connection's
/// first line (if empty, it asks for help). `table` defines the named lines.
/// Telnet negotiation (IAC …) belongs to its line and is skipped; a LF always ends the line. An unreadable
/// line gives kBad with error 7 and command -2, an unknown word error 1 and command -2; a known word with
/// wrong values gives the result of CheckRequest, with the word's command. More than 1 MiB without LF gives
/// kFatal, error 8.
Decoded DecodeText(std::string_view bytes, const CommandTable& table, bool first_line);
/// Appends the full form of `message` and '\n' to `out`. Doubles get the shortest digits that read back the
/// same. Control characters without an escape in the text form become '?': a terminal would obey them.
void EncodeText(const Message& message, std::string& out);
/// Appends one `#` line that names the values and units of `reply` by the spec of its command.
void EncodeVerbose(const Message& reply, const CommandTable& table, std::string& out);
/// The `#` lines that `help` prints.
std::string HelpText(const CommandTable& table);
/// Appends `value` with the digits of Python's repr, which read back as the same double; always with '.',
/// 'e', "inf" or "nan".
void AppendDouble(double value, std::string& out);

// --- the first bytes
// ---------------------------------------------------------------------------------------------
/// The encoding that a client's first bytes choose.
enum class FirstBytes {
  kUndecided,   // need more bytes
  kBinary,      // "CDS1": 4 bytes to skip
  kWrongMagic,  // "CDS" and something else
  kHttp,        // METHOD SP … HTTP/: answer 400 and close
  kText,
};
/// From this many bytes on, SniffEncoding never returns kUndecided.
inline constexpr std::size_t kMaxSniffBytes = 8192;
FirstBytes SniffEncoding(std::string_view bytes);

/// Number of characters in UTF-8 `text`.
std::size_t CharacterCount(std::string_view text);
/// True if `text` is well-formed UTF-8 (RFC 3629) without NUL.
bool IsCleanUtf8(std::string_view text);

}  // namespace coopdyn
