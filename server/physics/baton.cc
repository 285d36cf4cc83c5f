// SPDX-License-Identifier: MIT
#include "server/physics/stepper.h"

namespace coopdyn {

void Baton::Take() {
  while (taken_.exchange(true, std::memory_order_acquire)) taken_.wait(true, std::memory_order_relaxed);
}

bool Baton::TryTake() {
  return !taken_.exchange(true, std::memory_order_acquire);
}

void Baton::Pass() {
  taken_.store(false, std::memory_order_release);
  taken_.notify_one();
}

}  // namespace coopdyn
