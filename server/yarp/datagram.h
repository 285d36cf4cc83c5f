// SPDX-License-Identifier: MIT
// How messages of YARP are cut into datagrams: a checksum, a number from 0 on within the message, a piece of
// it. Pure functions of bytes; any thread. The layout follows YARP 3.12 and 4.0 (src/libYARP_os,
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

/// Puts messages together again. One sender.
class DatagramJoiner {
 public:
  /// The messages that are whole now, one after the other, mostly none or one. One of which a datagram is
  /// missing or spoiled is dropped.
  std::string Add(std::string_view datagram);

 private:
  void Drop();

  std::string pieces_;
  std::int32_t next_ = 0;
};

}  // namespace coopdyn
