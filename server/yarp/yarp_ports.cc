// SPDX-License-Identifier: MIT
#include "server/yarp/yarp_ports.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace coopdyn {

void YarpPorts::Open(const std::string& name, Endpoint& module, IoThread& io, const std::string& asker) {
  const auto parsed = ParseYarpPortName(name);
  if (!parsed || !HasYarpPort(*parsed, name, module.path(), module.table())) return;
  if (const auto there = ports_.find(name); there != ports_.end()) {
    if (asker.empty()) there->second.asker.clear();
    return;
  }
  if (!asker.empty()) MakeRoom(asker);
  auto port = YarpPort::Open(name, module, addresses_, io, net_, names_);
  if (port != nullptr) ports_.emplace(name, Held{std::move(port), &module, asker});
}

bool YarpPorts::IsKept(const std::string& name) const {
  const auto found = ports_.find(name);
  return found != ports_.end() && found->second.asker.empty();
}

void YarpPorts::CloseOf(const Endpoint& module, const std::string& notice) {
  for (auto it = ports_.begin(); it != ports_.end();) {
    if (it->second.module != &module) {
      ++it;
      continue;
    }
    it->second.port->Close(notice);
    it = ports_.erase(it);
  }
}

void YarpPorts::CloseUnused(Nanoseconds now) {
  for (const auto& [name, held] : ports_) {
    if (held.port->session_count() > 0) names_.Touch(name, now);
  }
  std::erase_if(ports_, [&](const auto& port) {
    return IsUnused(port.second) && now - AskedAt(port.first) >= kKeptFor;
  });
}

Nanoseconds YarpPorts::AskedAt(const std::string& name) const {
  const std::optional<NameEntry> entry = names_.Find(name);
  return entry ? entry->used : 0;
}

void YarpPorts::MakeRoom(const std::string& asker) {
  std::size_t its = 0, all = 0;
  auto oldest = ports_.end(), oldest_of_all = ports_.end();
  Nanoseconds asked = 0, asked_of_all = 0;
  for (auto it = ports_.begin(); it != ports_.end(); ++it) {
    if (!IsUnused(it->second)) continue;
    const Nanoseconds at = AskedAt(it->first);
    if (all++ == 0 || at < asked_of_all) {
      oldest_of_all = it;
      asked_of_all = at;
    }
    if (it->second.asker != asker) continue;
    if (its++ == 0 || at < asked) {
      oldest = it;
      asked = at;
    }
  }
  if (its >= kMaxUnused) {
    ports_.erase(oldest);
  } else if (all >= kMaxUnusedOfAll) {
    ports_.erase(oldest_of_all);
  }
}

}  // namespace coopdyn
