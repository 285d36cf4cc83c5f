// SPDX-License-Identifier: MIT
// Memory that the daemon shares with the controllers' process: an anonymous file, mapped on both sides. It is
// sealed: nobody can make it smaller, so what is mapped stays there. One owner.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "server/base/clock.h"
#include "server/controllers/shared_layout.h"

namespace coopdyn {

class SharedArea {
 public:
  /// What other processes that have the file may do.
  enum class Others { kRead, kWrite };

  /// A new area of `bytes`, zeroed, read and written here. Throws std::system_error.
  SharedArea(std::size_t bytes, Others others);
  /// What another process has made: maps all of the file `fd`, which it then owns. Throws std::system_error.
  SharedArea(int fd, bool writable);
  ~SharedArea();
  SharedArea(const SharedArea&) = delete;
  SharedArea& operator=(const SharedArea&) = delete;

  /// Makes it at least this large; pointers into it are void. Throws std::system_error.
  void Grow(std::size_t bytes);
  /// Maps the first `bytes` of the file, which another process has made larger; pointers into it are void.
  void Remap(std::size_t bytes);

  int fd() const { return fd_; }
  std::size_t bytes() const { return bytes_; }

  template <typename T>
  T* At(Place place) const {
    return reinterpret_cast<T*>(data_ + place);
  }

 private:
  explicit SharedArea(int fd) : fd_(fd) {}
  void Map(std::size_t bytes, bool writable);

  const int fd_;
  std::size_t bytes_ = 0;
  std::byte* data_ = nullptr;
};

/// Hands out places one after the other.
class Layout {
 public:
  explicit Layout(Place end = 0) : end_(end) {}
  /// A place for `count` values of type T, aligned for it, and at least to 8 bytes.
  template <typename T>
  Place Add(std::size_t count) {
    return AddBytes(count * sizeof(T), alignof(T) < 8 ? 8 : alignof(T));
  }
  Place AddBytes(std::size_t bytes, std::size_t align) {
    const Place place = (end_ + align - 1) / align * align;
    end_ = place + bytes;
    return place;
  }
  Place end() const { return end_; }

 private:
  Place end_;
};

/// The two areas of a set of controllers.
struct Areas {
  SharedArea in, out;

  InHeader& header() const { return *in.At<InHeader>(0); }
  OutHeader& out_header() const { return *out.At<OutHeader>(0); }
  RobotSetup& setup(std::uint32_t robot) const { return in.At<RobotSetup>(header().robots)[robot]; }
  RobotReadings& readings(std::uint32_t robot) const {
    return in.At<RobotReadings>(header().readings)[robot];
  }
  FileResult& file_result(std::uint32_t file) const {
    return out.At<FileResult>(header().file_results)[file];
  }
  RobotResult& result(std::uint32_t robot) const {
    return out.At<RobotResult>(header().robot_results)[robot];
  }
  char* text(std::uint32_t robot) const { return out.At<char>(header().texts) + robot * kTextSize; }

  /// Makes them at least this large; pointers into them are void. Throws std::system_error.
  void Grow(std::size_t in_bytes, std::size_t out_bytes) {
    in.Grow(in_bytes);
    out.Grow(out_bytes);
    header().in_bytes = in.bytes();
    header().out_bytes = out.bytes();
  }
  /// What is to be done next.
  void Order(Operation operation, std::span<const std::uint32_t> items, int workers) const {
    header().operation = operation;
    header().item_count = static_cast<std::uint32_t>(items.size());
    header().workers = static_cast<std::uint32_t>(workers);
    std::copy(items.begin(), items.end(), in.At<std::uint32_t>(header().items));
  }
};

/// Sleeps until somebody wakes waiters of `word`, but not if it is not `value` any more; across processes.
/// May return early. `at_most` 0: without limit.
void FutexWait(const std::atomic<std::uint32_t>& word, std::uint32_t value, Nanoseconds at_most);

/// Wakes one waiter.
void FutexWake(std::atomic<std::uint32_t>& word);

}  // namespace coopdyn
