// SPDX-License-Identifier: MIT
#include "server/controllers/guarded_buffer.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace coopdyn {

namespace {

std::size_t PageSize() {
  return static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

GuardedBuffer::GuardedBuffer(std::size_t bytes) {
  const std::size_t page = PageSize();
  const std::size_t room = (bytes + page - 1) / page * page;
  void* start =
      mmap(nullptr, room + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (start == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "mmap");
  start_ = static_cast<std::byte*>(start);
  end_ = start_ + room;
  if (mprotect(end_, page, PROT_NONE) != 0) {
    const int error = errno;
    munmap(start, room + page);
    throw std::system_error(error, std::generic_category(), "mprotect");
  }
}

GuardedBuffer::~GuardedBuffer() {
  if (start_ != nullptr) munmap(start_, static_cast<std::size_t>(end_ - start_) + PageSize());
}

GuardedBuffer::GuardedBuffer(GuardedBuffer&& other) noexcept
    : start_(std::exchange(other.start_, nullptr)), end_(std::exchange(other.end_, nullptr)) {}

}  // namespace coopdyn
