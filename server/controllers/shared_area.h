// SPDX-License-Identifier: MIT
// Memory that the daemon shares with the controllers' process: an anonymous file, mapped on both sides. A
// seal prevents shrinking, so mapped pages stay valid. One owner.
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
  /// The access of other processes that have the file.
  enum class Others { kRead, kWrite };

  /// Makes a zeroed area of `bytes`, mapped for reading and writing. Throws std::system_error.
  SharedArea(std::size_t bytes, Others others);
  /// Maps all of the file `fd`, made by another process, and takes ownership of `fd`. Throws
  /// std::system_error.
  SharedArea(int fd, bool writable);
  ~SharedArea();
  SharedArea(const SharedArea&) = delete;
  SharedArea& operator=(const SharedArea&) = delete;

  /// Grows the area to at least `bytes`; invalidates pointers into it. Throws std::system_error.
  void Grow(std::size_t bytes);
  /// Maps the first `bytes` of the file, which another process has grown; invalidates pointers into it.
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

/// Allocates consecutive places.
class Layout {
 public:
  explicit Layout(Place end = 0) : end_(end) {}
  /// A place for `count` values of type T, aligned for T and to at least 8 bytes.
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

  /// Grows both areas to at least these sizes; invalidates pointers into them. Throws std::system_error.
  void Grow(std::size_t in_bytes, std::size_t out_bytes) {
    in.Grow(in_bytes);
    out.Grow(out_bytes);
    header().in_bytes = in.bytes();
    header().out_bytes = out.bytes();
  }
  /// Writes the next operation to the header.
  void Order(Operation operation, std::span<const std::uint32_t> items, int workers) const {
    header().operation = operation;
    header().item_count = static_cast<std::uint32_t>(items.size());
    header().workers = static_cast<std::uint32_t>(workers);
    std::copy(items.begin(), items.end(), in.At<std::uint32_t>(header().items));
  }
};

/// Sleeps until a thread of any process wakes waiters of `word`; returns at once if `word` is not `value`.
/// May return early. `at_most` 0: no limit.
void FutexWait(const std::atomic<std::uint32_t>& word, std::uint32_t value, Nanoseconds at_most);

/// Wakes one waiter.
void FutexWake(std::atomic<std::uint32_t>& word);

}  // namespace coopdyn
