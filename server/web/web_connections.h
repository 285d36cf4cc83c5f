// SPDX-License-Identifier: MIT
// Who is connected to the web server, and who may be besides: nobody takes so much that others find no room.
// UI thread.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/net/peer.h"

namespace coopdyn {

/// A connection that can be told to end.
class WebConnection {
 public:
  virtual ~WebConnection() = default;
  virtual void Close() = 0;
};

struct WebLimits {
  std::size_t loopback = 256;    // connections from this machine, which others cannot use up
  std::size_t per_address = 64;  // from any other address
  std::size_t others = 256;      // from all other addresses
};

/// What a connection is counted under: "loopback", the IPv4 address, or the first 64 bits of the IPv6
/// address, of which one subscriber has all the rest.
std::string NetworkOf(const PeerInfo& peer);

class WebConnections {
 public:
  enum class Verdict {
    kServe,
    kRefuse,  // with an answer that says why
    kDrop     // too many are being refused already
  };
  /// How many connections beyond a limit get an answer.
  static constexpr std::size_t kRefusedAtOnce = 32;

  explicit WebConnections(WebLimits limits) : limits_(limits) {}

  /// Whether one more connection of `peer` is served. When the room for others is full, the network that has
  /// most gives up its oldest connection for one that has less.
  Verdict Admit(const PeerInfo& peer);
  /// Counts `connection` as long as it lives.
  void Add(const std::shared_ptr<WebConnection>& connection, const PeerInfo& peer);
  void CloseAll();

 private:
  struct Entry {
    std::weak_ptr<WebConnection> connection;
    std::string network;
  };
  std::size_t Count(std::string_view network) const;
  /// Closes the oldest connection of the network that has most, if that is more than `own` and one. False if
  /// none has.
  bool MakeRoom(std::size_t own);

  const WebLimits limits_;
  std::vector<Entry> entries_;  // oldest first
};

}  // namespace coopdyn
