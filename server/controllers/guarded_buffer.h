// SPDX-License-Identifier: MIT
// Memory that ends where no byte may be touched: what writes past its end is caught in the act. One owner.
#pragma once

#include <cstddef>

namespace coopdyn {

class GuardedBuffer {
 public:
  /// Room for `bytes`. Throws std::system_error.
  explicit GuardedBuffer(std::size_t bytes);
  ~GuardedBuffer();
  GuardedBuffer(GuardedBuffer&& other) noexcept;
  GuardedBuffer& operator=(GuardedBuffer&&) = delete;

  /// The last `bytes` of it, aligned to `align` (a power of 2): at most `align` - 1 bytes follow before the
  /// guard.
  void* Last(std::size_t bytes, std::size_t align) const {
    return end_ - (bytes + align - 1) / align * align;
  }

 private:
  std::byte* start_ = nullptr;
  std::byte* end_ = nullptr;  // the guard's first byte
};

}  // namespace coopdyn
