// SPDX-License-Identifier: MIT
#include "server/web/web_connections.h"

#include <algorithm>
#include <map>
#include <utility>

#include "server/base/wrong_tokens.h"

namespace coopdyn {
namespace {

constexpr std::string_view kLoopback = "loopback";

}  // namespace

std::string NetworkOf(const PeerInfo& peer) {
  return peer.trusted ? std::string(kLoopback) : NetworkOf(peer.text);
}

WebConnections::Verdict WebConnections::Admit(const PeerInfo& peer) {
  std::erase_if(entries_, [](const Entry& entry) { return entry.connection.expired(); });
  const std::string network = NetworkOf(peer);
  const std::size_t own = Count(network);
  const bool local = network == kLoopback;
  const std::size_t limit = local ? limits_.loopback : limits_.per_address;
  if (own >= limit + kRefusedAtOnce) return Verdict::kDrop;
  if (own >= limit) return Verdict::kRefuse;
  if (local) return Verdict::kServe;
  const std::size_t others = entries_.size() - Count(kLoopback);
  if (others < limits_.others || MakeRoom(own)) return Verdict::kServe;
  return others < limits_.others + kRefusedAtOnce ? Verdict::kRefuse : Verdict::kDrop;
}

void WebConnections::Add(const std::shared_ptr<WebConnection>& connection, const PeerInfo& peer) {
  entries_.push_back({connection, NetworkOf(peer)});
}

void WebConnections::CloseAll() {
  for (const Entry& entry : std::exchange(entries_, {})) {
    if (const auto connection = entry.connection.lock()) connection->Close();
  }
}

std::size_t WebConnections::Count(std::string_view network) const {
  return static_cast<std::size_t>(std::count_if(
      entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.network == network; }));
}

bool WebConnections::MakeRoom(std::size_t own) {
  std::map<std::string_view, std::size_t> counts;
  for (const Entry& entry : entries_) {
    if (entry.network != kLoopback) ++counts[entry.network];
  }
  const auto most = std::max_element(counts.begin(), counts.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most == counts.end() || most->second <= own + 1) return false;
  const auto oldest = std::find_if(entries_.begin(), entries_.end(),
                                   [&](const Entry& entry) { return entry.network == most->first; });
  const std::shared_ptr<WebConnection> connection = oldest->connection.lock();
  entries_.erase(oldest);
  if (connection) connection->Close();
  return true;
}

}  // namespace coopdyn
