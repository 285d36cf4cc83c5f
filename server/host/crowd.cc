// SPDX-License-Identifier: MIT
#include "server/host/crowd.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

Crowd::Ticket Crowd::Enter(const std::string& who, std::function<void()> leave) {
  const auto mine = counts_.find(who);
  if (mine != counts_.end() && mine->second >= most_of_one_) {
    EndOldestOf(who);
  } else if (guests_.size() >= most_) {
    const auto greediest =
        std::ranges::max_element(counts_, {}, [](const auto& each) { return each.second; });
    EndOldestOf(std::string(greediest->first));
  }
  guests_.emplace(++last_, Guest{who, std::move(leave)});
  ++counts_[who];
  return last_;
}

void Crowd::Leave(Ticket ticket) {
  const auto found = guests_.find(ticket);
  if (found == guests_.end()) return;
  const auto count = counts_.find(found->second.who);
  if (--count->second == 0) counts_.erase(count);
  guests_.erase(found);
}

void Crowd::Clear() {
  counts_.clear();
  for (const auto& [ticket, guest] : std::exchange(guests_, {})) guest.leave();
}

void Crowd::EndOldestOf(const std::string& who) {
  const auto oldest = std::ranges::find(guests_, who, [](const auto& each) { return each.second.who; });
  const std::function<void()> leave = std::move(oldest->second.leave);
  Leave(oldest->first);
  leave();
}

}  // namespace coopdyn
