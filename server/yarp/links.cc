// SPDX-License-Identifier: MIT
#include "server/yarp/links.h"

#include <fcntl.h>
#include <sys/socket.h>

#include <utility>

namespace coopdyn {

YarpLinks::Id YarpLinks::Add(YarpLink link, const UniqueFd& session) {
  Id oldest = 0, id = 0;
  {
    const MutexLock lock(mutex_);
    std::size_t inputs = link.way == YarpLink::Way::kIn ? 1 : 0;
    for (const auto& [number, entry] : entries_) {
      if (inputs == 0 || entry.link.way != YarpLink::Way::kIn) continue;
      if (inputs++ == 1) oldest = number;
    }
    if (inputs <= kMaxInputs) oldest = 0;
    id = ++last_;
    entries_.emplace(id, Entry{std::move(link), UniqueFd(::fcntl(session.get(), F_DUPFD_CLOEXEC, 0))});
  }
  if (oldest != 0) End(oldest);
  return id;
}

void YarpLinks::Forget(Id id) {
  const MutexLock lock(mutex_);
  entries_.erase(id);
}

bool YarpLinks::Has(Id id) const {
  const MutexLock lock(mutex_);
  return entries_.contains(id);
}

bool YarpLinks::End(const std::string& port, const std::string& other, YarpLink::Way way) {
  Id found = 0;
  {
    const MutexLock lock(mutex_);
    for (const auto& [id, entry] : entries_) {
      const YarpLink& link = entry.link;
      if (link.port == port && link.other == other && link.way == way) found = id;
    }
  }
  if (found != 0) End(found);
  return found != 0;
}

void YarpLinks::End(Id id) {
  const MutexLock lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return;
  ::shutdown(found->second.socket.get(), SHUT_RD);
  entries_.erase(found);
}

std::vector<YarpLink> YarpLinks::From(const std::string& port) const {
  const MutexLock lock(mutex_);
  std::vector<YarpLink> found;
  for (const auto& [id, entry] : entries_) {
    if (entry.link.port == port && entry.link.way == YarpLink::Way::kOut) found.push_back(entry.link);
  }
  return found;
}

}  // namespace coopdyn
