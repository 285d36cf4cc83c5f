// SPDX-License-Identifier: MIT
// Reads messages whose data are many: from the socket straight into the vector that is handed out. One
// thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "protocol/message.h"

namespace coopdyn::client {

/// Takes the next message to be as long as the last one, so that it mostly comes in one piece and with one
/// system call; whatever length it has, it is read right.
class BulkReader {
 public:
  /// The next message from the non-blocking socket `fd`; nothing if not all of it has come. Throws Closed if
  /// the peer has closed, and Error 7 for what is no message.
  std::optional<Message> Read(int fd);
  /// Forgets what was read of a message: for a new connection.
  void Clear();
  /// Memory for the data of a later message.
  void Recycle(std::vector<double> values) { spare_ = std::move(values); }

 private:
  bool Receive(int fd);
  void SizeUp();
  Message Take();
  std::size_t total() const { return head_.size() + sizeof(double) * data_.size(); }

  std::string head_ = std::string(24, '\0');  // header, text and params
  std::vector<double> data_, spare_;
  std::size_t have_ = 0;  // bytes that are there: of head_, then of data_
  bool sized_ = false;    // head_ and data_ have the sizes that the header tells
  std::string early_;     // bytes of the message after this one
};

}  // namespace coopdyn::client
