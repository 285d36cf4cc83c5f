// SPDX-License-Identifier: MIT
// The message of coopdyn's protocol, used in both directions. Pure data; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace coopdyn {

/// Error codes of a reply (docs/protocol.md).
enum class Error : std::int32_t {
  kOk = 0,
  kUnknownCommand = 1,
  kWrongParams = 2,
  kWrongData = 3,
  kOutOfRange = 4,   // or not finite
  kNotPossible = 5,  // in this mode or state
  kOwned = 6,        // by another client
  kMalformed = 7,
  kTooLarge = 8,
  kInternal = 9,
  kNoSuchName = 10,
  kTimedOut = 11,
  kNotAllowed = 12,
};

/// CoopDynSim's generic message: error, text, command, M params, N data.
struct Message {
  std::int32_t error = 0;
  std::string text;  // UTF-8 without NUL
  std::int32_t command = 0;
  std::vector<std::int32_t> params;
  std::vector<double> data;

  bool operator==(const Message&) const = default;
};

/// A successful reply to `command`; the caller adds params and data.
Message ReplyTo(std::int32_t command, std::string text = {});

/// Builds the error reply to `command`: no params, no data.
Message ErrorReply(std::int32_t command, Error error, std::string text);

/// The meaning of an error code in docs/protocol.md, e.g. "wrong params"; "unknown error" if it has none.
std::string_view ErrorMeaning(std::int32_t error);

}  // namespace coopdyn
