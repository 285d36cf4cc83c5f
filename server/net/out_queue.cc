// SPDX-License-Identifier: MIT
#include "server/net/out_queue.h"

#include <utility>

namespace coopdyn {
namespace {

constexpr std::size_t kKeepCapacity = std::size_t{256} << 10;  // beyond it memory is given back
constexpr std::size_t kSharedBytes = std::size_t{64} << 10;    // of pushes that keep their bytes for all

std::size_t BinaryBytes(const Message& message) {
  return 20 + message.text.size() + 4 * message.params.size() + 8 * message.data.size();
}

}  // namespace

void OutQueue::AddReply(Message reply) {
  Item item;
  item.reply = std::move(reply);
  Add(std::move(item));
}

void OutQueue::AddRaw(std::string bytes) {
  Item item;
  item.raw = std::move(bytes);
  Add(std::move(item));
}

void OutQueue::Add(Item item) {
  if (encoding_ == Encoding::kUndecided && item.reply) return;
  if (MayEncode()) return Encode(std::move(item));
  item.after = pushes_gone_ + pushes_.size();
  items_.push_back(std::move(item));
}

void OutQueue::AddPush(const UnaskedPtr& push, std::int64_t dropped) {
  if (encoding_ == Encoding::kUndecided) return;
  if (MayEncode()) return EncodePush({push, dropped});
  pushes_.push_back({push, dropped});
  if (pushes_.size() <= kMaxPushes) return;
  lost_ += pushes_.front().dropped + 1;
  pushes_.pop_front();
  ++pushes_gone_;
}

OutQueue::Push OutQueue::TakePush() {
  Push push = std::move(pushes_.front());
  pushes_.pop_front();
  ++pushes_gone_;
  return push;
}

void OutQueue::Encode(Item item) {
  if (item.reply) {
    EncodeWhole(std::move(*item.reply));
  } else {
    bytes_ += item.raw;
  }
}

void OutQueue::EncodePush(const Push& push) {
  lost_ += push.dropped;
  const Message* message = push.message->message();
  if (message == nullptr) return;
  if (lost_ == 0 && BinaryBytes(*message) <= kSharedBytes) {
    bytes_ += push.message->bytes(encoding_);
    if (verbose_ && encoding_ == Encoding::kText) EncodeVerbose(*message, table_, bytes_);
    return;
  }
  Message own = *message;
  if (lost_ > 0) {
    const std::string note = "dropped " + std::to_string(std::exchange(lost_, 0));
    own.text = own.text.empty() ? note : note + " " + own.text;
  }
  EncodeWhole(std::move(own));
}

void OutQueue::EncodeWhole(Message message) {
  const std::size_t before = bytes_.size();
  if (BinaryBytes(message) <= kMaxReplyBytes) EncodeMessage(message);
  if (bytes_.size() == before || bytes_.size() - before > kMaxReplyBytes) {
    bytes_.resize(before);
    const std::size_t limit_mib = kMaxReplyBytes >> 20;
    message = ErrorReply(message.command, Error::kTooLarge,
                         "the reply is larger than " + std::to_string(limit_mib) + " MiB: ask for less");
    EncodeMessage(message);
  }
  if (verbose_ && encoding_ == Encoding::kText) EncodeVerbose(message, table_, bytes_);
}

void OutQueue::EncodeMessage(const Message& message) {
  if (encoding_ == Encoding::kBinary) {
    EncodeBinary(message, bytes_);
  } else {
    EncodeText(message, bytes_);
  }
}

bool OutQueue::Fill() {
  while (waits() && unsent().size() < kEncodeAhead) {
    if (!items_.empty() && items_.front().after <= pushes_gone_) {
      Encode(std::move(items_.front()));
      items_.pop_front();
    } else {
      EncodePush(TakePush());
    }
  }
  return sent_ < bytes_.size();
}

void OutQueue::Sent(std::size_t count) {
  sent_ += count;
  if (sent_ < bytes_.size()) {
    if (sent_ >= kEncodeAhead && sent_ >= bytes_.size() - sent_) {  // moved at most once
      bytes_.erase(0, sent_);
      sent_ = 0;
    }
    return;
  }
  bytes_.clear();
  sent_ = 0;
  if (bytes_.capacity() > kKeepCapacity) bytes_.shrink_to_fit();
}

void OutQueue::Clear() {
  bytes_.clear();
  sent_ = 0;
  items_.clear();
  pushes_.clear();
}

}  // namespace coopdyn
