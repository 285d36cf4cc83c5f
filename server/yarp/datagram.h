// SPDX-License-Identifier: MIT
// Splits YARP messages into datagrams: a checksum, a number counted from 0 in each message, and a piece of
// the message. Pure functions of bytes; any thread. The layout follows YARP 3.12 and 4.0 (src/libYARP_os,
// DgramTwoWayStream).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace coopdyn {

inline constexpr std::size_t kMaxDatagramBytes = 65000;

/// The datagrams of one message.
std::vector<std::string> CutIntoDatagrams(std::string_view message);

/// Reassembles the messages of one sender.
class DatagramJoiner {
 public:
  /// Returns the messages that are now complete, concatenated; usually none or one. Drops a message with a
  /// missing or corrupt datagram.
  std::string Add(std::string_view datagram);

 private:
  void Drop();

  std::string pieces_;
  std::int32_t next_ = 0;
};

}  // namespace coopdyn
