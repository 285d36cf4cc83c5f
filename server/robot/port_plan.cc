// SPDX-License-Identifier: MIT
#include "server/robot/port_plan.h"

#include <algorithm>
#include <utility>

namespace coopdyn {

PortPlan::PortPlan(int first, std::function<bool(int)> is_foreign)
    : first_(first), is_foreign_(std::move(is_foreign)), lowest_(first) {}

int PortPlan::Take() {
  if (any_port()) return TakeAny();
  while (taken_.contains(lowest_)) ++lowest_;
  for (int port = lowest_; port <= kLast; ++port) {
    if (taken_.contains(port) || IsForeign(port)) continue;
    taken_.insert(port);
    return port;
  }
  return 0;
}

int PortPlan::TakeAny() {
  while (next_any_ != 0 && next_any_ <= kLast && IsForeign(next_any_)) ++next_any_;
  if (next_any_ > kLast) next_any_ = 0;
  return next_any_ == 0 ? 0 : next_any_++;
}

void PortPlan::Reserve(int port) {
  if (port != 0) taken_.insert(port);
}

void PortPlan::Release(int port) {
  if (taken_.erase(port) > 0 && port >= first_) lowest_ = std::min(lowest_, port);
}

}  // namespace coopdyn
