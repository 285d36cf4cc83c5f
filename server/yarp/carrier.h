// SPDX-License-Identifier: MIT
// What goes over a connection of YARP beside the Bottles: handshakes, frames, acknowledgements. Pure
// functions of bytes; any thread. The layout follows YARP 3.12 and 4.0, whose carriers are the same.
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
  kFastTcp,  // does not
  kUdp,
  kText,     // lines
  kTextAck,  // lines, each acknowledged
  kOther,    // none of ours
};
/// "tcp", "fast_tcp", …
std::string_view CarrierName(YarpCarrier carrier);
/// The reverse; kOther if it is none of ours.
YarpCarrier CarrierNamed(std::string_view name);
inline bool IsText(YarpCarrier carrier) {
  return carrier == YarpCarrier::kText || carrier == YarpCarrier::kTextAck;
}

/// Whether a connection begins as those of YARP do.
Match BeginsYarp(std::string_view first_bytes);

/// The next thing that a peer said.
struct YarpInput {
  enum class Kind {
    kNeedMore,
    kHello,    // `text`: the peer's name, without its qualifiers
    kCommand,  // `text`: d, D, a, q, *, r, ?, /other, … ; `payload` follows d, D and a
    kBroken,   // `text`: why. Nothing can be read after it
  };
  Kind kind = Kind::kNeedMore;
  std::size_t consumed = 0;
  std::string text = {};
  std::string envelope = {};  // of d and D: "3598 1795221119.87"; empty: none
  std::string payload = {};   // a Bottle, in bytes or, if the carrier is one of text, as text
};

/// Reads what the side that opened a connection sends. One connection.
class YarpReader {
 public:
  static constexpr std::size_t kMaxNameBytes = 1000;

  /// `bytes` begin with what was not consumed before. @pre BeginsYarp() was kYes for the first ones
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
  // Of a text message that has begun:
  std::size_t scanned_ = 0;  // bytes
  YarpInput line_;           // what they hold so far
  OpenBottle bottle_;
  bool in_bottle_ = false;  // the command has been read
};

/// What the accepting side answers to a hello of `name`; `port`: its own.
std::string YarpWelcome(YarpCarrier carrier, std::string_view name, int port);
/// What it sends when it has handled a message; empty if the carrier wants none.
std::string_view YarpAck(YarpCarrier carrier);

// --- of the side that opens a connection
/// Its first bytes: it calls itself `name`.
std::string YarpHello(YarpCarrier carrier, std::string_view name);
/// The size of the other side's welcome at the beginning of `bytes`. 0: more must come; nothing: it is none.
std::optional<std::size_t> WelcomeBytes(YarpCarrier carrier, std::string_view bytes);
/// The port in the welcome of a binary carrier.
int WelcomePort(std::string_view welcome);
/// Appends a message: `command` is "q", or "D 3598 12.5" with an envelope; `payload` as YarpInput has it.
void AppendYarpMessage(YarpCarrier carrier, std::string_view command, std::string_view payload,
                       std::string& out);

}  // namespace coopdyn
