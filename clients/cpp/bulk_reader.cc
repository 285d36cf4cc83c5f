// SPDX-License-Identifier: MIT
#include "clients/cpp/bulk_reader.h"

#include <sys/uio.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

#include "clients/cpp/error.h"
#include "protocol/codec.h"

namespace coopdyn::client {
namespace {

constexpr std::size_t kHeaderBytes = 24;  // size, error, command, T, M, N

std::uint32_t Field(const char* bytes, std::size_t index) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= std::uint32_t{static_cast<unsigned char>(bytes[4 * index + i])} << (8 * i);
  return value;
}

}  // namespace

std::optional<Message> BulkReader::Read(int fd) {
  while (true) {
    if (!sized_ && have_ >= kHeaderBytes) SizeUp();
    if (sized_ && have_ == total()) return Take();
    if (!Receive(fd)) return std::nullopt;
  }
}

void BulkReader::Clear() {
  have_ = 0;
  sized_ = false;
  early_.clear();
}

/// Fills on from where it is; false if nothing has come.
bool BulkReader::Receive(int fd) {
  const std::size_t in_head = std::min(have_, head_.size());
  const std::size_t in_data = have_ - in_head;
  const iovec parts[] = {{head_.data() + in_head, head_.size() - in_head},
                         {reinterpret_cast<char*>(data_.data()) + in_data, total() - head_.size() - in_data}};
  if (!early_.empty()) {
    std::size_t taken = 0;
    for (const iovec& part : parts) {
      const std::size_t n = std::min(part.iov_len, early_.size() - taken);
      if (n > 0) std::memcpy(part.iov_base, early_.data() + taken, n);
      taken += n;
    }
    early_.erase(0, taken);
    have_ += taken;
    return true;
  }
  const ssize_t n = readv(fd, parts, 2);
  if (n > 0) {
    have_ += static_cast<std::size_t>(n);
    return true;
  }
  if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return false;
  throw Closed("");
}

/// The header is there: gives head_ and data_ their sizes, if they are not those of the last message.
void BulkReader::SizeUp() {
  const std::uint64_t size = Field(head_.data(), 0);
  const std::size_t text = Field(head_.data(), 3), params = Field(head_.data(), 4),
                    data = Field(head_.data(), 5);
  if (size > kMaxReplyBytes || size + 4 != kHeaderBytes + text + 4 * params + sizeof(double) * data)
    throw Error(7, "the bytes received are not a coopdyn message");
  const std::size_t head = kHeaderBytes + text + 4 * params;
  if (head != head_.size() || data != data_.size()) {
    std::string bytes = head_.substr(0, have_);
    if (have_ > head_.size()) bytes.append(reinterpret_cast<const char*>(data_.data()), have_ - head_.size());
    early_.insert(0, bytes);
    head_.resize(head);
    data_.resize(data);
    have_ = 0;
  }
  sized_ = true;
}

Message BulkReader::Take() {
  Message message;
  message.error = static_cast<std::int32_t>(Field(head_.data(), 1));
  message.command = static_cast<std::int32_t>(Field(head_.data(), 2));
  const std::size_t text = Field(head_.data(), 3);
  message.text.assign(head_, kHeaderBytes, text);
  message.params.resize(Field(head_.data(), 4));
  for (std::size_t i = 0; i < message.params.size(); ++i)
    message.params[i] = static_cast<std::int32_t>(Field(head_.data() + kHeaderBytes + text, i));
  const std::size_t count = data_.size();
  if constexpr (std::endian::native == std::endian::big) {
    for (double& value : data_) {
      auto* bytes = reinterpret_cast<char*>(&value);
      std::reverse(bytes, bytes + sizeof(double));
    }
  }
  message.data = std::move(data_);
  data_ = std::exchange(spare_, {});
  data_.resize(count);
  have_ = 0;
  sized_ = false;
  return message;
}

}  // namespace coopdyn::client
