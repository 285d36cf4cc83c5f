// SPDX-License-Identifier: MIT
#include "server/naming/name_table.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "protocol/command_table.h"

namespace coopdyn {
namespace {

constexpr int kFirstPort = 12000;
constexpr int kLastPort = 19999;
constexpr std::size_t kMaxNameBytes = 255;
constexpr std::size_t kMaxTypeBytes = 32;
constexpr std::size_t kMaxIpBytes = 64;

/// Names reserved for the daemon, whether in use or not.
constexpr std::array<std::string_view, 7> kReserved = {"/simulation", "/world", "/swarm", "/playback",
                                                       "/recorder",   "/root",  "/clock"};

bool IsGraphic(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return c > ' ' && c < 127; });
}

std::string WithSlash(std::string_view name) {
  return name.starts_with('/') ? std::string(name) : "/" + std::string(name);
}

bool IsThisMachine(const std::string& ip) {
  return ip.empty() || ip == "::1" || ip.starts_with("127.");
}

/// The registrar as entries store it: this machine has many addresses.
std::string RegistrarOf(const NameAsker& asker) {
  return IsThisMachine(asker.ip) ? std::string() : asker.ip;
}

/// Why the asker may not change `entry`; empty: it may.
std::string RightProblem(const NameEntry& entry, const NameAsker& asker) {
  if (!entry.external) return entry.name + " is a name of the daemon";
  const std::string registrar = RegistrarOf(asker);
  if (registrar.empty() || registrar == entry.registrar) return {};
  const bool here = entry.registrar.empty();
  return entry.name + " was registered by a program on " + (here ? "the daemon's machine" : entry.registrar) +
         ": only programs there" + (here ? "" : " or on the daemon's machine") + " may change it";
}

/// The approximate size of an entry.
std::size_t Bytes(const NameEntry& entry) {
  constexpr std::size_t kAlways = 128;
  std::size_t bytes = kAlways + entry.name.size() + entry.ip.size() + entry.type.size();
  for (const auto& [key, value] : entry.properties) bytes += kAlways + key.size() + value.size();
  return bytes;
}

}  // namespace

std::string NameProblem(const std::string& name) {
  if (name.size() < 2 || name[0] != '/') return "a name starts with /, as in /tracker/out";
  if (name.size() > kMaxNameBytes)
    return "a name has at most " + std::to_string(kMaxNameBytes) + " characters";
  if (!IsGraphic(name) || name.find_first_of("()\"\\@") != std::string::npos) {
    return "a name has no spaces, quotes, backslashes, parentheses, @ or letters beyond ASCII";
  }
  return {};
}

NameTable::NameTable() : first_port_(kFirstPort), last_port_(kLastPort) {}

void NameTable::SetExternalPorts(int first, int last, std::function<bool(int)> is_free) {
  MutexLock lock(mutex_);
  is_free_ = std::move(is_free);
  first_port_ = std::clamp(first, 1, 65535);
  last_port_ = std::clamp(last, first_port_, 65535);
}

bool NameTable::IsExternalPort(int port) const {
  MutexLock lock(mutex_);
  return external_ports_.contains(port);
}

bool NameTable::AddOwn(const std::string& name, int port, AdoptFunction adopt, NameKind kind) {
  MutexLock lock(mutex_);
  const auto it = entries_.find(name);
  if (it != entries_.end()) {
    if (!it->second.external) return false;
    ForgetPortLocked(it->second);
  }
  NameEntry entry;
  entry.name = name;
  entry.port = port;
  entry.adopt = std::move(adopt);
  entry.kind = kind;
  entries_.insert_or_assign(name, std::move(entry));
  return true;
}

void NameTable::RemoveOwn(const std::string& name) {
  MutexLock lock(mutex_);
  const auto it = entries_.find(name);
  if (it != entries_.end() && !it->second.external) entries_.erase(it);
}

std::optional<NameEntry> NameTable::Find(std::string_view name) const {
  MutexLock lock(mutex_);
  const NameEntry* entry = FindLocked(name);
  return entry == nullptr ? std::nullopt : std::optional(*entry);
}

std::vector<NameEntry> NameTable::List(std::string_view prefix) const {
  MutexLock lock(mutex_);
  std::vector<NameEntry> list;
  for (auto it = entries_.lower_bound(prefix); it != entries_.end() && it->first.starts_with(prefix); ++it) {
    list.push_back(it->second);
  }
  return list;
}

std::string NameTable::Nearest(std::string_view name) const {
  constexpr std::size_t kLongest = 100;  // longer input gets no suggestion
  if (name.size() > kLongest) return {};
  const std::string wanted = WithSlash(name);
  MutexLock lock(mutex_);
  std::string nearest;
  std::size_t best = 2 + wanted.size() / 4;  // a larger distance is no misspelling
  for (const auto& [candidate, entry] : entries_) {
    if (candidate.size() >= wanted.size() + best || wanted.size() >= candidate.size() + best) continue;
    const std::size_t distance = EditDistance(wanted, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  // For "robot1" alone: its motors, or its first module.
  if (entries_.contains(wanted + "/motors")) return wanted + "/motors";
  const auto module = entries_.lower_bound(wanted + "/");
  if (module != entries_.end() && module->first.starts_with(wanted + "/")) return module->first;
  return nearest;
}

NameTable::Change NameTable::Register(const std::string& name, const std::string& type, const std::string& ip,
                                      int port, const NameAsker& asker) {
  MutexLock lock(mutex_);
  NameEntry entry;
  entry.external = true;
  entry.name = name;
  entry.ip = ip.empty() ? asker.ip : ip;
  entry.registrar = RegistrarOf(asker);
  entry.used = asker.now;
  if (!type.empty()) entry.type = type;
  if (name.empty()) {
    do {
      entry.name = "/tmp/port/" + std::to_string(next_temporary_++);
    } while (entries_.contains(entry.name));
  }
  if (std::string problem = NameProblem(entry.name); !problem.empty()) return {problem};
  for (const std::string_view reserved : kReserved) {
    if (entry.name == reserved) return {entry.name + " is a name of the daemon"};
  }
  if (entry.type.size() > kMaxTypeBytes || !IsGraphic(entry.type)) return {"the type is one word, as tcp"};
  if (entry.ip.size() > kMaxIpBytes || !IsGraphic(entry.ip)) return {"the address is one word, as 127.0.0.1"};
  if (!entry.registrar.empty() && entry.ip != entry.registrar) {
    return {"a program on another machine registers its own address alone: write " + entry.registrar +
            ", or ... for it"};
  }
  if (port < 0 || port > 65535) return {"a port is a number from 1 to 65535, or ... for a free one"};
  const auto it = entries_.find(entry.name);
  if (it != entries_.end()) {
    NameEntry& old = it->second;
    if (!old.external) return {entry.name + " is a name of the daemon"};
    const bool same_place = old.ip == entry.ip && (port == 0 || port == old.port);
    if (same_place) {
      if (RightProblem(old, asker).empty()) old.used = asker.now;
      return {{}, old};
    }
    const std::string problem = RightProblem(old, asker);
    return {entry.name + " is registered already, at " + old.ip + " port " + std::to_string(old.port) + "; " +
            (problem.empty() ? "unregister it first" : problem)};
  }
  if (std::string problem = RoomProblemLocked(entry.registrar, 1, Bytes(entry)); !problem.empty()) {
    return {problem};
  }
  entry.port = port != 0 ? port : FreePortLocked();
  if (entry.port == 0) return {"no free port"};
  entries_.emplace(entry.name, entry);
  external_ports_.insert(entry.port);
  return {{}, entry};
}

NameTable::Change NameTable::Unregister(std::string_view name, const NameAsker& asker) {
  MutexLock lock(mutex_);
  const auto it = entries_.find(name);
  if (it == entries_.end()) return {};
  if (std::string problem = RightProblem(it->second, asker); !problem.empty()) return {problem};
  Change change{{}, it->second};
  ForgetPortLocked(it->second);
  entries_.erase(it);
  return change;
}

NameTable::Change NameTable::SetProperty(std::string_view name, const std::string& key,
                                         const std::string& value, const NameAsker& asker) {
  MutexLock lock(mutex_);
  const auto it = entries_.find(name);
  if (it == entries_.end()) return {};
  NameEntry& entry = it->second;
  if (std::string problem = RightProblem(entry, asker); !problem.empty()) return {problem};
  if (key.size() > kMaxKeyBytes || value.size() > kMaxValueBytes) {
    return {"a property's name has at most " + std::to_string(kMaxKeyBytes) + " bytes, its value " +
            std::to_string(kMaxValueBytes)};
  }
  if (!entry.properties.contains(key) && entry.properties.size() >= kMaxProperties) {
    return {"too many properties of " + entry.name};
  }
  NameEntry changed = entry;
  changed.properties[key] = value;
  changed.used = asker.now;
  const std::size_t before = Bytes(entry), after = Bytes(changed);
  if (after > before) {
    if (std::string problem = RoomProblemLocked(entry.registrar, 0, after - before); !problem.empty()) {
      return {problem};
    }
  }
  entry = std::move(changed);
  return {{}, entry};
}

bool NameTable::Subscribe(const Subscription& subscription) {
  MutexLock lock(mutex_);
  if (subscriptions_.size() >= kMaxSubscriptions && !subscriptions_.contains(subscription)) return false;
  subscriptions_.insert(subscription);
  return true;
}

void NameTable::Unsubscribe(const Subscription& subscription) {
  MutexLock lock(mutex_);
  subscriptions_.erase(subscription);
}

std::vector<Subscription> NameTable::Subscriptions(std::string_view name) const {
  MutexLock lock(mutex_);
  std::vector<Subscription> found;
  for (const Subscription& each : subscriptions_) {
    if (name.empty() || each.from == name || each.to == name) found.push_back(each);
  }
  return found;
}

void NameTable::Touch(std::string_view name, Nanoseconds now) {
  MutexLock lock(mutex_);
  const auto it = entries_.find(name);
  if (it != entries_.end()) it->second.used = now;
}

void NameTable::Forget(Nanoseconds now) {
  MutexLock lock(mutex_);
  if (now < next_forgotten_) return;
  next_forgotten_ = now + kForgottenAfter;
  for (auto it = entries_.begin(); it != entries_.end();) {
    const NameEntry& entry = it->second;
    if (entry.external && now - entry.used >= kForgottenAfter) {
      ForgetPortLocked(entry);
      it = entries_.erase(it);
      continue;
    }
    if (entry.external) next_forgotten_ = std::min(next_forgotten_, entry.used + kForgottenAfter);
    ++it;
  }
}

void NameTable::ForgetPortLocked(const NameEntry& entry) {
  external_ports_.erase(external_ports_.find(entry.port));
}

std::string NameTable::RoomProblemLocked(const std::string& registrar, std::size_t names,
                                         std::size_t bytes) const {
  std::size_t its_names = names, its_bytes = bytes, all_bytes = bytes;
  for (const auto& [name, entry] : entries_) {
    if (!entry.external) continue;
    const std::size_t size = Bytes(entry);
    all_bytes += size;
    if (entry.registrar != registrar) continue;
    ++its_names;
    its_bytes += size;
  }
  if (!registrar.empty() && (its_names > kMaxOfAddress || its_bytes > kMaxBytesOfAddress)) {
    return "too many names or properties of this address: unregister some";
  }
  if (external_ports_.size() + names > kMaxExternal || all_bytes > kMaxExternalBytes) return "too many names";
  return {};
}

const NameEntry* NameTable::FindLocked(std::string_view name) const {
  auto it = entries_.find(name);
  if (it == entries_.end() && !name.starts_with('/')) it = entries_.find(WithSlash(name));
  return it == entries_.end() ? nullptr : &it->second;
}

int NameTable::FreePortLocked() const {
  std::set<int> taken;
  for (const auto& [name, entry] : entries_) taken.insert(entry.port);
  for (int port = first_port_; port <= last_port_; ++port) {
    if (!taken.contains(port) && (!is_free_ || is_free_(port))) return port;
  }
  return 0;
}

}  // namespace coopdyn
