// SPDX-License-Identifier: MIT
#include "server/controllers/shared_area.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#ifndef F_SEAL_FUTURE_WRITE
#define F_SEAL_FUTURE_WRITE 0x0010  // Linux 5.1
#endif

namespace coopdyn {

namespace {

void Require(bool fine, const char* what) {
  if (!fine) throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

SharedArea::SharedArea(std::size_t bytes, Others others) : bytes_(bytes) {
  fd_ = memfd_create("coopdyn-controllers", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  Require(fd_ >= 0, "memfd_create");
  owns_fd_ = true;
  try {
    Require(ftruncate(fd_, static_cast<off_t>(bytes)) == 0, "ftruncate");
    Map(true);
    const int seals =
        F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL | (others == Others::kRead ? F_SEAL_FUTURE_WRITE : 0);
    Require(fcntl(fd_, F_ADD_SEALS, seals) == 0, "the kernel cannot seal memory (Linux 5.1 can)");
  } catch (...) {
    Free();
    throw;
  }
}

SharedArea::SharedArea(int fd, bool writable) : fd_(fd) {
  struct stat status {};
  Require(fstat(fd, &status) == 0, "fstat");
  bytes_ = static_cast<std::size_t>(status.st_size);
  Map(writable);
}

SharedArea::~SharedArea() {
  Free();
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

void SharedArea::Map(bool writable) {
  void* data = mmap(nullptr, bytes_, writable ? PROT_READ | PROT_WRITE : PROT_READ, MAP_SHARED, fd_, 0);
  Require(data != MAP_FAILED, "mmap");
  data_ = static_cast<std::byte*>(data);
}

void SharedArea::Free() {
  if (data_ != nullptr) munmap(data_, bytes_);
  data_ = nullptr;
  if (owns_fd_) close(fd_);
  owns_fd_ = false;
}

}  // namespace coopdyn
