// SPDX-License-Identifier: MIT
// Memory that two processes share: an anonymous file, mapped. It is sealed: nobody can make it smaller or
// larger, so that what is mapped stays there. One owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "server/controllers/shared_layout.h"

namespace coopdyn {

class SharedArea {
 public:
  /// What other processes that have the file may do.
  enum class Others { kRead, kWrite };

  SharedArea() = default;
  /// A new area of `bytes`, zeroed, read and written here. Throws std::system_error.
  SharedArea(std::size_t bytes, Others others);
  /// What another process has made: maps all of the file `fd`, which it does not own.
  SharedArea(int fd, bool writable);
  ~SharedArea();
  SharedArea(SharedArea&& other) noexcept;
  SharedArea& operator=(SharedArea&& other) noexcept;

  int fd() const { return fd_; }
  std::size_t bytes() const { return bytes_; }
  std::byte* data() const { return data_; }

  template <typename T>
  T* At(Place place) const {
    return reinterpret_cast<T*>(data_ + place);
  }

 private:
  void Map(bool writable);
  void Free();

  int fd_ = -1;
  bool owns_fd_ = false;
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

}  // namespace coopdyn
