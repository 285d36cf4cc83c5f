// SPDX-License-Identifier: MIT
// What a session has yet to send: replies, pushes and lines, encoded as late as possible so that pushes can
// still be dropped whole. No sockets. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/codec.h"
#include "protocol/command_table.h"
#include "protocol/message.h"
#include "server/net/endpoint.h"

namespace coopdyn {

class OutQueue {
 public:
  /// Pushes that wait for a peer that does not read; then the oldest is dropped.
  static constexpr std::size_t kMaxPushes = 64;
  /// Encoded at once without waiting for what is before it.
  static constexpr std::size_t kEncodeAhead = std::size_t{64} << 10;

  /// `table` outlives it.
  explicit OutQueue(const CommandTable& table) : table_(table) {}

  /// kBinary or kText; nothing is sent in others.
  void set_encoding(Encoding encoding) { encoding_ = encoding; }
  /// Text only: a `#` line that names the values follows each reply.
  void set_verbose(bool verbose) { verbose_ = verbose; }
  /// While the peer takes nothing, messages are kept apart instead of being encoded ahead.
  void set_blocked(bool blocked) { blocked_ = blocked; }

  void AddReply(Message reply);
  /// Beyond kMaxPushes the oldest that has not begun is dropped; the next one's text then starts with
  /// `dropped N`. `dropped`: how many were lost before this one. One that waits is composed when its turn
  /// comes.
  void AddPush(const UnaskedPtr& push, std::int64_t dropped = 0);
  /// Bytes as they are, e.g. `#` lines.
  void AddRaw(std::string bytes);

  /// Encodes what waits, up to about kEncodeAhead. Returns false if nothing is left to send.
  bool Fill();
  std::string_view unsent() const { return std::string_view(bytes_).substr(sent_); }
  void Sent(std::size_t count);
  bool empty() const { return sent_ == bytes_.size() && !waits(); }
  void Clear();

 private:
  struct Push {
    UnaskedPtr message;
    std::int64_t dropped = 0;
  };
  /// A reply, or bytes as they are.
  struct Item {
    std::uint64_t after = 0;  // how many pushes
    std::optional<Message> reply = {};
    std::string raw = {};
  };

  bool waits() const { return !items_.empty() || !pushes_.empty(); }
  /// Nothing is before what comes now, and the peer takes it.
  bool MayEncode() const { return !blocked_ && !waits() && unsent().size() < kEncodeAhead; }
  void Add(Item item);
  void Encode(Item item);
  void EncodePush(const Push& push);
  void EncodeWhole(Message message);
  void EncodeMessage(const Message& message);
  Push TakePush();

  const CommandTable& table_;
  Encoding encoding_ = Encoding::kUndecided;
  bool verbose_ = false;
  bool blocked_ = false;
  std::string bytes_;     // encoded
  std::size_t sent_ = 0;  // of bytes_
  // Not yet encoded; they follow bytes_.
  std::deque<Item> items_;
  std::deque<Push> pushes_;
  std::uint64_t pushes_gone_ = 0;  // encoded or dropped
  std::int64_t lost_ = 0;          // dropped pushes that the next one tells of
};

}  // namespace coopdyn
