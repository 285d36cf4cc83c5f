// SPDX-License-Identifier: MIT
#include "server/controllers/shared_area.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <system_error>

#ifndef F_SEAL_FUTURE_WRITE
#define F_SEAL_FUTURE_WRITE 0x0010  // Linux 5.1
#endif

namespace coopdyn {

namespace {

void Require(bool fine, const char* what) {
  if (!fine) throw std::system_error(errno, std::generic_category(), what);
}

std::size_t FileBytes(int fd) {
  struct stat status {};
  Require(fstat(fd, &status) == 0, "fstat");
  return static_cast<std::size_t>(status.st_size);
}

}  // namespace

// Constructors delegate to SharedArea(int), so the destructor runs if they throw.

SharedArea::SharedArea(std::size_t bytes, Others others)
    : SharedArea(memfd_create("coopdyn-controllers", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
  Require(fd_ >= 0, "memfd_create");
  Require(ftruncate(fd_, static_cast<off_t>(bytes)) == 0, "ftruncate");
  Map(bytes, true);
  // Mappings made after F_SEAL_FUTURE_WRITE cannot write; this one can.
  const int seals = F_SEAL_SHRINK | F_SEAL_SEAL | (others == Others::kRead ? F_SEAL_FUTURE_WRITE : 0);
  Require(fcntl(fd_, F_ADD_SEALS, seals) == 0, "the kernel cannot seal memory (Linux 5.1 can)");
}

SharedArea::SharedArea(int fd, bool writable) : SharedArea(fd) {
  Map(FileBytes(fd), writable);
}

SharedArea::~SharedArea() {
  if (data_ != nullptr) munmap(data_, bytes_);
  if (fd_ >= 0) close(fd_);
}

void SharedArea::Map(std::size_t bytes, bool writable) {
  void* data = mmap(nullptr, bytes, writable ? PROT_READ | PROT_WRITE : PROT_READ, MAP_SHARED, fd_, 0);
  Require(data != MAP_FAILED, "mmap");
  data_ = static_cast<std::byte*>(data);
  bytes_ = bytes;
}

void SharedArea::Grow(std::size_t bytes) {
  if (bytes <= bytes_) return;
  // A controller may have grown the file; it cannot shrink again.
  if (FileBytes(fd_) < bytes) Require(ftruncate(fd_, static_cast<off_t>(bytes)) == 0, "ftruncate");
  Remap(bytes);
}

void SharedArea::Remap(std::size_t bytes) {
  if (bytes == bytes_) return;
  void* data = mremap(data_, bytes_, bytes, MREMAP_MAYMOVE);
  Require(data != MAP_FAILED, "mremap");
  data_ = static_cast<std::byte*>(data);
  bytes_ = bytes;
}

void FutexWait(const std::atomic<std::uint32_t>& word, std::uint32_t value, Nanoseconds at_most) {
  timespec limit{};
  limit.tv_sec = at_most / kNanosecondsPerSecond;
  limit.tv_nsec = at_most % kNanosecondsPerSecond;
  syscall(SYS_futex, &word, FUTEX_WAIT, value, at_most == 0 ? nullptr : &limit, nullptr, 0);
}

void FutexWake(std::atomic<std::uint32_t>& word) {
  syscall(SYS_futex, &word, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

}  // namespace coopdyn
