// SPDX-License-Identifier: MIT
// The parts of YARP's wire format besides Bottles: handshakes, frames, acknowledgements. Pure functions of
// bytes; any thread. The layout follows YARP 3.12 and 4.0, which have the same carriers.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "server/net/encoding.h"
#include "server/yarp/bottle.h"

namespace coopdyn {

enum class YarpCarrier {
  kTcp,      // acknowledges each message
  kFastTcp,  // without acknowledgements
  kUdp,
  kText,     // lines
  kTextAck,  // lines, each acknowledged
  kOther,    // not supported
};
/// "tcp", "fast_tcp", …
std::string_view CarrierName(YarpCarrier carrier);
/// The reverse; kOther if not supported.
YarpCarrier CarrierNamed(std::string_view name);
inline bool IsText(YarpCarrier carrier) {
  return carrier == YarpCarrier::kText || carrier == YarpCarrier::kTextAck;
}

/// Whether a connection begins like a YARP connection.
Match BeginsYarp(std::string_view first_bytes);

/// The next item of a peer's input.
struct YarpInput {
  enum class Kind {
    kNeedMore,
    kHello,    // `text`: the peer's name, without its qualifiers
    kCommand,  // `text`: d, D, a, q, *, r, ?, /other, … ; `payload` follows d, D and a
    kBroken,   // `text`: the reason. Nothing after it can be read
  };
  Kind kind = Kind::kNeedMore;
  std::size_t consumed = 0;
  std::string text = {};
  std::string envelope = {};  // after d and D: "3598 1795221119.87"; empty: none
  std::string payload = {};   // a Bottle: bytes, or text if the carrier is a text carrier
};

/// Reads the input from the side that opened a connection. One connection.
class YarpReader {
 public:
  static constexpr std::size_t kMaxNameBytes = 1000;

  /// `bytes` begin with those not consumed before. @pre BeginsYarp() was kYes for the first ones
  YarpInput Next(std::string_view bytes);

  YarpCarrier carrier() const { return carrier_; }
  bool is_text() const { return IsText(carrier_); }

 private:
  YarpInput Hello(std::string_view bytes);
  YarpInput Frame(std::string_view bytes);
  YarpInput Line(std::string_view bytes);
  YarpInput TakeLine();

  YarpCarrier carrier_ = YarpCarrier::kOther;
  bool greeted_ = false;
  // State of an incomplete text message:
  std::size_t scanned_ = 0;  // bytes
  YarpInput line_;           // its contents so far
  OpenBottle bottle_;
  bool in_bottle_ = false;  // its command is complete
};

/// The accepting side's answer to a hello of `name`; `port`: its own.
std::string YarpWelcome(YarpCarrier carrier, std::string_view name, int port);
/// The acknowledgement of a handled message; empty if the carrier has none.
std::string_view YarpAck(YarpCarrier carrier);

// --- the side that opens a connection
/// Its first bytes, with its name `name`.
std::string YarpHello(YarpCarrier carrier, std::string_view name);
/// The size of the accepting side's welcome at the start of `bytes`; 0: incomplete; nullopt: not a welcome.
std::optional<std::size_t> WelcomeBytes(YarpCarrier carrier, std::string_view bytes);
/// The port in the welcome of a binary carrier.
int WelcomePort(std::string_view welcome);
/// Appends a message: `command` is "q", or "D 3598 12.5" with an envelope; `payload` as in YarpInput.
void AppendYarpMessage(YarpCarrier carrier, std::string_view command, std::string_view payload,
                       std::string& out);

}  // namespace coopdyn
