// SPDX-License-Identifier: MIT
// A session's pending output: replies, pushes and lines. Pushes are encoded as late as possible, so they can
// still be dropped whole. No sockets. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "protocol/message.h"
#include "server/net/encoding.h"
#include "server/net/endpoint.h"

namespace coopdyn {

class OutQueue {
 public:
  /// Most pushes that wait for a slow peer; beyond that the oldest is dropped.
  static constexpr std::size_t kMaxPushes = 64;
  /// Unsent bytes below which a message is encoded at once.
  static constexpr std::size_t kEncodeAhead = std::size_t{64} << 10;

  /// `encoding` outlives it; messages are dropped until it is set.
  void set_encoding(Encoding& encoding) { encoding_ = &encoding; }
  /// While the peer does not read, messages are queued instead of encoded ahead.
  void set_blocked(bool blocked) { blocked_ = blocked; }

  void AddReply(const Message& reply);
  /// An unasked message that is never dropped.
  void AddNotice(Message notice);
  /// If more than kMaxPushes wait, drops the oldest one not yet encoded; the next one's text then starts with
  /// `dropped N`. `dropped`: number lost before this one. A waiting push is composed when its turn comes.
  void AddPush(const UnaskedPtr& push, std::int64_t dropped = 0);
  /// Appends bytes unchanged, e.g. `#` lines.
  void AddRaw(std::string_view bytes);

  /// Encodes waiting messages, up to about kEncodeAhead. Returns false if nothing is left to send.
  bool Fill();
  /// Drops pushes that wait for an acknowledgement, because none can arrive.
  void GiveUpPushes();
  std::string_view unsent() const { return std::string_view(bytes_).substr(sent_); }
  void Sent(std::size_t count);
  bool empty() const { return sent_ == bytes_.size() && !waits(); }
  void Clear();

 private:
  struct Push {
    UnaskedPtr message;
    std::int64_t dropped = 0;
  };
  /// An encoded message other than a push.
  struct Item {
    std::uint64_t after = 0;  // number of pushes before it
    std::string bytes = {};
  };

  bool may_push() const { return encoding_ == nullptr || encoding_->takes_push(); }
  bool waits() const { return !items_.empty() || !pushes_.empty(); }
  /// True if nothing waits before a new message and the peer reads.
  bool MayEncode() const { return !blocked_ && !waits() && unsent().size() < kEncodeAhead; }
  /// The string to append the next message's bytes to.
  std::string& Tail();
  void EncodePush(const Push& push);
  void EncodeAlone(Message push, std::string& out);
  /// Limits the message that has been appended to `out`, which was `before` bytes long: replaces it by an
  /// error if it is too large.
  void LimitTo(std::size_t before, const Message& message, std::string& out);
  Push TakePush();

  Encoding* encoding_ = nullptr;
  bool blocked_ = false;
  std::string bytes_;     // encoded
  std::size_t sent_ = 0;  // of bytes_
  // Follow bytes_.
  std::deque<Item> items_;
  std::deque<Push> pushes_;
  std::uint64_t pushes_gone_ = 0;  // encoded or dropped
  std::int64_t lost_ = 0;          // dropped pushes not yet reported to the peer
};

}  // namespace coopdyn
