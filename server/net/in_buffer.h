// SPDX-License-Identifier: MIT
// Received bytes that a session has not yet used: one reused block that grows only for a message that needs
// it. One thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

namespace coopdyn {

class InBuffer {
 public:
  static constexpr std::size_t kFirstBytes = 4096;
  static constexpr std::size_t kMinRoom = 1024;
  static constexpr std::size_t kKeepBytes = std::size_t{64} << 10;  // a larger block is freed once empty

  std::string_view bytes() const { return {storage_.data() + begin_, end_ - begin_}; }
  std::size_t size() const { return end_ - begin_; }
  void Consume(std::size_t count) { begin_ += count; }
  void Clear() { begin_ = end_; }

  /// Free room to read into, at least kMinRoom. bytes() stays valid until the next call.
  std::span<char> Room() {
    if (begin_ == end_) {
      begin_ = end_ = 0;
      if (storage_.size() > kKeepBytes) storage_ = {};
    }
    if (storage_.size() - end_ < kMinRoom && begin_ > 0 && begin_ >= size()) {
      std::memmove(storage_.data(), storage_.data() + begin_, size());
      end_ -= begin_;
      begin_ = 0;
    }
    if (storage_.size() - end_ < kMinRoom) storage_.resize(std::max(kFirstBytes, 2 * storage_.size()));
    return {storage_.data() + end_, storage_.size() - end_};
  }
  /// Call after reading `count` bytes into Room().
  void Added(std::size_t count) { end_ += count; }
  void Append(std::string_view bytes) {
    while (!bytes.empty()) {
      const std::span<char> room = Room();
      const std::size_t count = std::min(room.size(), bytes.size());
      std::memcpy(room.data(), bytes.data(), count);
      Added(count);
      bytes.remove_prefix(count);
    }
  }

 private:
  std::vector<char> storage_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace coopdyn
