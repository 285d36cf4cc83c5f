// SPDX-License-Identifier: MIT
// Memory for a controller's output, with a guard page.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <memory>
#include <system_error>

namespace coopdyn {

/// Memory followed by an inaccessible page: a write past the end crashes at once.
class GuardedBuffer {
 public:
  /// Allocates `bytes`. Throws std::system_error.
  explicit GuardedBuffer(std::size_t bytes) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t room = (bytes + page - 1) / page * page;
    void* start = mmap(nullptr, room + page, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (start == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "mmap");
    start_ = {static_cast<std::byte*>(start), Unmap{room + page}};
    guard_ = start_.get() + room;
    if (mprotect(guard_, page, PROT_NONE) != 0) {
      throw std::system_error(errno, std::generic_category(), "mprotect");
    }
  }

  /// The last `bytes` of the buffer, aligned to `align` (a power of 2): at most `align` - 1 bytes lie between
  /// them and the guard.
  void* Last(std::size_t bytes, std::size_t align) const {
    return guard_ - (bytes + align - 1) / align * align;
  }

 private:
  struct Unmap {
    std::size_t bytes;
    void operator()(std::byte* start) const { munmap(start, bytes); }
  };
  std::unique_ptr<std::byte, Unmap> start_;
  std::byte* guard_ = nullptr;
};

}  // namespace coopdyn
