// SPDX-License-Identifier: MIT
// The connections of the web server, limited per network so that no client can lock out the rest. UI thread.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/net/peer.h"

namespace coopdyn {

/// A connection that can be closed.
class WebConnection {
 public:
  virtual ~WebConnection() = default;
  virtual void Close() = 0;
};

struct WebLimits {
  std::size_t loopback = 256;    // connections from this machine, reserved for it
  std::size_t per_address = 64;  // from any other address
  std::size_t others = 256;      // from all other addresses
};

/// The network under which a connection is counted: "loopback", the IPv4 address, or the first 64 bits of the
/// IPv6 address (one subscriber owns all addresses with these).
std::string NetworkOf(const PeerInfo& peer);

class WebConnections {
 public:
  enum class Verdict {
    kServe,
    kRefuse,  // answer with the reason, then close
    kDrop     // close without an answer: too many are being refused
  };
  /// Connections beyond a limit that still receive an answer.
  static constexpr std::size_t kRefusedAtOnce = 32;

  explicit WebConnections(WebLimits limits) : limits_(limits) {}

  /// Decides whether to serve another connection of `peer`. At the limit of all other addresses, closes the
  /// oldest connection of the network with the most, if the peer's network has fewer.
  Verdict Admit(const PeerInfo& peer);
  /// Counts `connection` while it lives.
  void Add(const std::shared_ptr<WebConnection>& connection, const PeerInfo& peer);
  void CloseAll();

 private:
  struct Entry {
    std::weak_ptr<WebConnection> connection;
    std::string network;
  };
  std::size_t Count(std::string_view network) const;
  /// Closes the oldest connection of the network with the most, if it has more than `own` + 1. Returns
  /// whether it did.
  bool MakeRoom(std::size_t own);

  const WebLimits limits_;
  std::vector<Entry> entries_;  // oldest first
};

}  // namespace coopdyn
