// SPDX-License-Identifier: MIT
// The codecs: pure incremental functions, bytes in; a message, "need more" or "bad" out. No sockets, no locale.
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
  kNothing,   // `consumed` bytes are done with, nothing to answer (comment, empty line, telnet negotiation)
  kHelp,      // text only: print help as # lines (`help`, or the first empty line)
  kVerbose,   // text only: turn on verbose replies
};

struct Decoded {
  DecodeStatus status = DecodeStatus::kNeedMore;
  std::size_t consumed = 0;
  Message message;
};

// --- binary -----------------------------------------------------------------------------------------------------
/// Decodes the first frame of `bytes` (after the magic). `max_bytes` limits `size`.
/// Once the header says a scenario text (command 108) follows, kMaxTextsBytes applies instead.
Decoded DecodeBinary(std::string_view bytes, std::size_t max_bytes = kMaxRequestBytes);
/// Appends the frame of `message` to `out`.
void EncodeBinary(const Message& message, std::string& out);

// --- text -------------------------------------------------------------------------------------------------------
/// Decodes the first line of `bytes`. `first_line`: nothing but telnet negotiation came before on this connection
/// (an empty first line asks for help). `table` gives named lines their meaning.
Decoded DecodeText(std::string_view bytes, const CommandTable& table, bool first_line);
/// Appends the full form of `message` and '\n' to `out`. Doubles print shortest and read back the same.
void EncodeText(const Message& message, std::string& out);
/// Appends one `#` line that names the values and units of `reply` by the spec of its command.
void EncodeVerbose(const Message& reply, const CommandTable& table, std::string& out);
/// The `#` lines that `help` prints.
std::string HelpText(const CommandTable& table);
/// Appends `value` so that reading gives the same double; always with '.', 'e', "inf" or "nan".
void AppendDouble(double value, std::string& out);

// --- the first bytes ---------------------------------------------------------------------------------------------
/// What the first bytes of a client choose.
enum class Encoding {
  kUndecided,    // need more bytes
  kBinary,       // "CDS1": 4 bytes to skip
  kWrongMagic,   // "CDS" and something else
  kHttp,         // METHOD SP … HTTP/: answer 400 and close
  kText,
};
Encoding SniffEncoding(std::string_view bytes);

/// True if `text` is well-formed UTF-8 (RFC 3629) without NUL.
bool IsCleanUtf8(std::string_view text);

}  // namespace coopdyn
