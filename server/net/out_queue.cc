// SPDX-License-Identifier: MIT
#include "server/net/out_queue.h"

#include <utility>

#include "protocol/codec.h"

namespace coopdyn {
namespace {

constexpr std::size_t kKeepCapacity = std::size_t{256} << 10;  // larger buffers are freed
constexpr std::size_t kSharedBytes = std::size_t{64} << 10;    // larger pushes are encoded for each
                                                               // connection separately

std::size_t BinaryBytes(const Message& message) {
  return 20 + message.text.size() + 4 * message.params.size() + 8 * message.data.size();
}

}  // namespace

std::string& OutQueue::Tail() {
  if (MayEncode()) return bytes_;
  return items_.emplace_back(Item{pushes_gone_ + pushes_.size(), {}}).bytes;
}

void OutQueue::AddReply(const Message& reply) {
  if (encoding_ == nullptr) return;
  std::string& out = Tail();
  const std::size_t before = out.size();
  if (BinaryBytes(reply) <= kMaxReplyBytes) encoding_->Reply(reply, out);
  LimitTo(before, reply, out);
}

void OutQueue::AddNotice(Message notice) {
  if (encoding_ != nullptr) EncodeAlone(std::move(notice), Tail());
}

void OutQueue::AddRaw(std::string_view bytes) {
  Tail() += bytes;
}

void OutQueue::AddPush(const UnaskedPtr& push, std::int64_t dropped) {
  if (encoding_ == nullptr) return;
  if (MayEncode() && may_push()) return EncodePush({push, dropped});
  pushes_.push_back({push, dropped});
  if (pushes_.size() <= kMaxPushes) return;
  lost_ += TakePush().dropped + 1;
}

OutQueue::Push OutQueue::TakePush() {
  Push push = std::move(pushes_.front());
  pushes_.pop_front();
  ++pushes_gone_;
  return push;
}

void OutQueue::EncodePush(const Push& push) {
  lost_ += push.dropped;
  const Message* message = push.message->message();
  if (message == nullptr) return;
  if (lost_ == 0 && BinaryBytes(*message) <= kSharedBytes) return encoding_->Push(*push.message, bytes_);
  Message own = *message;
  if (lost_ > 0) {
    const std::string note = "dropped " + std::to_string(std::exchange(lost_, 0));
    own.text = own.text.empty() ? note : note + " " + own.text;
  }
  EncodeAlone(std::move(own), bytes_);
}

void OutQueue::EncodeAlone(Message push, std::string& out) {
  UnaskedMessage alone(std::move(push));
  const std::size_t before = out.size();
  if (BinaryBytes(*alone.message()) <= kMaxReplyBytes) encoding_->Push(alone, out);
  LimitTo(before, *alone.message(), out);
}

void OutQueue::LimitTo(std::size_t before, const Message& message, std::string& out) {
  if (BinaryBytes(message) <= kMaxReplyBytes && out.size() - before <= kMaxReplyBytes) return;
  out.resize(before);
  encoding_->Reply(
      ErrorReply(message.command, Error::kTooLarge,
                 "the reply is larger than " + std::to_string(kMaxReplyBytes >> 20) + " MiB: ask for less"),
      out);
}

bool OutQueue::Fill() {
  while (waits() && unsent().size() < kEncodeAhead) {
    if (!items_.empty() && items_.front().after <= pushes_gone_) {
      bytes_ += items_.front().bytes;
      items_.pop_front();
    } else if (may_push()) {
      EncodePush(TakePush());
    } else {
      break;
    }
  }
  return sent_ < bytes_.size();
}

void OutQueue::GiveUpPushes() {
  if (!may_push()) pushes_gone_ += std::exchange(pushes_, {}).size();
}

void OutQueue::Sent(std::size_t count) {
  sent_ += count;
  if (sent_ < bytes_.size()) {
    if (sent_ >= kEncodeAhead && sent_ >= bytes_.size() - sent_) {  // each byte is moved at most once
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
