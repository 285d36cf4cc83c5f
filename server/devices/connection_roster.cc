// SPDX-License-Identifier: MIT
#include "server/devices/connection_roster.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

void ConnectionRoster::Add(Entry entry) {
  const MutexLock lock(mutex_);
  const ClientId id = entry.id;
  entries_.insert_or_assign(id, std::move(entry));
}

void ConnectionRoster::SetName(ClientId id, const std::string& name) {
  const MutexLock lock(mutex_);
  const auto found = entries_.find(id);
  if (found != entries_.end()) found->second.name = name;
}

void ConnectionRoster::Remove(ClientId id) {
  const MutexLock lock(mutex_);
  entries_.erase(id);
}

std::vector<ConnectionRoster::Entry> ConnectionRoster::List(std::size_t max, std::size_t& total) const {
  const MutexLock lock(mutex_);
  total = entries_.size();
  std::vector<Entry> list;
  list.reserve(std::min(max, total));
  for (const auto& [id, entry] : entries_) {
    if (list.size() == max) break;
    list.push_back(entry);
  }
  return list;
}

}  // namespace coopdyn
