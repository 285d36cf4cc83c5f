// SPDX-License-Identifier: MIT
#include "server/controllers/same_core.h"

#include <sys/resource.h>
#include <unistd.h>

#include <utility>

namespace coopdyn {

namespace {

constexpr int kMostTurns = 32;

}  // namespace

void SameCore::SharePriority() {
  const int nice = getpriority(PRIO_PROCESS, 0);
  if (nice != nice_ && setpriority(PRIO_PGRP, static_cast<id_t>(other_), nice) == 0) nice_ = nice;
}

void SameCore::Take() {
  goes_on_ = std::exchange(taken_, true);
  if (turns_ > 0 && turns_ < kMostTurns && thread_ == std::this_thread::get_id()) {
    ++turns_;
    return;
  }
  Release();
  SharePriority();
  const int core = sched_getcpu();
  if (core < 0 || core >= CPU_SETSIZE || sched_getaffinity(0, sizeof(before_), &before_) != 0) return;
  cpu_set_t here;
  CPU_ZERO(&here);
  CPU_SET(static_cast<std::size_t>(core), &here);
  if (core != other_core_ && sched_setaffinity(other_, sizeof(here), &here) != 0) return;
  other_core_ = core;
  if (sched_setaffinity(0, sizeof(here), &here) != 0) return;
  thread_ = std::this_thread::get_id();
  tid_ = ::gettid();
  turns_ = 1;
}

void SameCore::Leave() {
  Release();
  taken_ = goes_on_ = false;
}

void SameCore::Release() {
  if (turns_ > 0) sched_setaffinity(tid_, sizeof(before_), &before_);
  turns_ = 0;
}

void SameCore::Free() {
  Leave();
  SharePriority();
  if (other_core_ < 0) return;
  cpu_set_t all;
  if (sched_getaffinity(0, sizeof(all), &all) == 0) sched_setaffinity(other_, sizeof(all), &all);
  other_core_ = -1;
}

}  // namespace coopdyn
