// SPDX-License-Identifier: MIT
#include "server/net/out_queue.h"

#include <algorithm>
#include <utility>

namespace coopdyn {
namespace {

constexpr std::size_t kKeepCapacity = std::size_t{256} << 10;  // beyond it memory is given back

std::size_t BinaryBytes(const Message& message) {
  return 20 + message.text.size() + 4 * message.params.size() + 8 * message.data.size();
}

}  // namespace

void OutQueue::AddReply(Message reply) {
  Item item;
  item.message = std::move(reply);
  Add(std::move(item));
}

void OutQueue::AddPush(const Message& push) {
  Item item;
  item.kind = Item::Kind::kPush;
  item.message = push;
  Add(std::move(item));
  if (pushes_ > kMaxPushes) DropOldestPush();
}

void OutQueue::AddRaw(std::string bytes) {
  Item item;
  item.kind = Item::Kind::kRaw;
  item.raw = std::move(bytes);
  Add(std::move(item));
}

void OutQueue::Add(Item item) {
  if (encoding_ == Encoding::kUndecided && item.kind != Item::Kind::kRaw) return;
  if (!blocked_ && items_.empty() && unsent().size() < kEncodeAhead) return Encode(item);
  if (item.kind == Item::Kind::kPush) ++pushes_;
  items_.push_back(std::move(item));
}

void OutQueue::DropOldestPush() {
  const auto is_push = [](const Item& item) { return item.kind == Item::Kind::kPush; };
  const auto oldest = std::find_if(items_.begin(), items_.end(), is_push);
  const auto next = std::find_if(oldest + 1, items_.end(), is_push);
  next->dropped += oldest->dropped + 1;
  items_.erase(oldest);
  --pushes_;
}

void OutQueue::Encode(Item& item) {
  if (item.kind == Item::Kind::kRaw) {
    bytes_ += item.raw;
    return;
  }
  if (item.dropped > 0) {
    const std::string note = "dropped " + std::to_string(item.dropped);
    item.message.text = item.message.text.empty() ? note : note + " " + item.message.text;
  }
  const std::size_t before = bytes_.size();
  if (BinaryBytes(item.message) <= kMaxReplyBytes) EncodeMessage(item.message);
  if (bytes_.size() == before || bytes_.size() - before > kMaxReplyBytes) {
    bytes_.resize(before);
    const std::size_t limit_mib = kMaxReplyBytes >> 20;
    item.message = ErrorReply(item.message.command, Error::kTooLarge,
                              "the reply is larger than " + std::to_string(limit_mib) + " MiB: ask for less");
    EncodeMessage(item.message);
  }
  if (verbose_ && encoding_ == Encoding::kText) EncodeVerbose(item.message, table_, bytes_);
}

void OutQueue::EncodeMessage(const Message& message) {
  if (encoding_ == Encoding::kBinary) {
    EncodeBinary(message, bytes_);
  } else {
    EncodeText(message, bytes_);
  }
}

bool OutQueue::Fill() {
  while (!items_.empty() && unsent().size() < kEncodeAhead) {
    if (items_.front().kind == Item::Kind::kPush) --pushes_;
    Encode(items_.front());
    items_.pop_front();
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
  pushes_ = 0;
}

}  // namespace coopdyn
