// SPDX-License-Identifier: MIT
#include "server/controllers/shared_area.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace coopdyn {

namespace {

[[noreturn]] void Fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

SharedArea::SharedArea(std::size_t bytes) : bytes_(bytes) {
  fd_ = memfd_create("coopdyn-controllers", MFD_CLOEXEC);
  if (fd_ < 0) Fail("memfd_create");
  owns_fd_ = true;
  if (ftruncate(fd_, static_cast<off_t>(bytes)) != 0) {
    const int error = errno;
    close(fd_);
    throw std::system_error(error, std::generic_category(), "ftruncate");
  }
  Map(true);
}

SharedArea::SharedArea(int fd, std::size_t bytes, bool writable) : fd_(fd), bytes_(bytes) {
  Map(writable);
}

SharedArea::~SharedArea() {
  Unmap();
  if (owns_fd_) close(fd_);
}

SharedArea::SharedArea(SharedArea&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      owns_fd_(std::exchange(other.owns_fd_, false)),
      bytes_(std::exchange(other.bytes_, 0)),
      data_(std::exchange(other.data_, nullptr)) {}

SharedArea& SharedArea::operator=(SharedArea&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(owns_fd_, other.owns_fd_);
  std::swap(bytes_, other.bytes_);
  std::swap(data_, other.data_);
  return *this;
}

void SharedArea::Grow(std::size_t bytes) {
  if (bytes <= bytes_) return;
  if (ftruncate(fd_, static_cast<off_t>(bytes)) != 0) Fail("ftruncate");
  Unmap();
  bytes_ = bytes;
  Map(true);
}

void SharedArea::Map(bool writable) {
  void* data = mmap(nullptr, bytes_, writable ? PROT_READ | PROT_WRITE : PROT_READ, MAP_SHARED, fd_, 0);
  if (data == MAP_FAILED) Fail("mmap");
  data_ = static_cast<std::byte*>(data);
}

void SharedArea::Unmap() {
  if (data_ != nullptr) munmap(data_, bytes_);
  data_ = nullptr;
}

}  // namespace coopdyn
