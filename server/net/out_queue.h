// SPDX-License-Identifier: MIT
// What a session has yet to send: replies, pushes and lines. Pushes are encoded as late as possible, so that
// they can still be dropped whole. No sockets. One thread.
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
  /// Pushes that wait for a peer that does not read; then the oldest is dropped.
  static constexpr std::size_t kMaxPushes = 64;
  /// Encoded at once without waiting for what is before it.
  static constexpr std::size_t kEncodeAhead = std::size_t{64} << 10;

  /// `encoding` outlives it; until it is set messages are dropped.
  void set_encoding(Encoding& encoding) { encoding_ = &encoding; }
  /// While the peer takes nothing, messages are kept apart instead of being encoded ahead.
  void set_blocked(bool blocked) { blocked_ = blocked; }

  void AddReply(const Message& reply);
  /// An unasked message that is never dropped.
  void AddNotice(Message notice);
  /// Beyond kMaxPushes the oldest that has not begun is dropped; the next one's text then starts with
  /// `dropped N`. `dropped`: how many were lost before this one. One that waits is composed when its turn
  /// comes.
  void AddPush(const UnaskedPtr& push, std::int64_t dropped = 0);
  /// Bytes as they are, e.g. `#` lines.
  void AddRaw(std::string_view bytes);

  /// Encodes what waits, up to about kEncodeAhead. Returns false if nothing is left to send.
  bool Fill();
  /// What waits for an acknowledgement does so no longer: none comes any more.
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
  /// Anything but a push, encoded.
  struct Item {
    std::uint64_t after = 0;  // how many pushes
    std::string bytes = {};
  };

  bool may_push() const { return encoding_ == nullptr || encoding_->takes_push(); }
  bool waits() const { return !items_.empty() || !pushes_.empty(); }
  /// Nothing is before what comes now, and the peer takes it.
  bool MayEncode() const { return !blocked_ && !waits() && unsent().size() < kEncodeAhead; }
  /// Where the bytes of what comes now go.
  std::string& Tail();
  void EncodePush(const Push& push);
  void EncodeAlone(Message push, std::string& out);
  /// Something has been appended to `out` for `message`, which was `before` bytes long: an error instead if
  /// that is too large.
  void LimitTo(std::size_t before, const Message& message, std::string& out);
  Push TakePush();

  Encoding* encoding_ = nullptr;
  bool blocked_ = false;
  std::string bytes_;     // encoded
  std::size_t sent_ = 0;  // of bytes_
  // They follow bytes_.
  std::deque<Item> items_;
  std::deque<Push> pushes_;
  std::uint64_t pushes_gone_ = 0;  // encoded or dropped
  std::int64_t lost_ = 0;          // dropped pushes that the next one tells of
};

}  // namespace coopdyn
