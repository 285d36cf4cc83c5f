// SPDX-License-Identifier: MIT
#include "server/web/frame_cadence.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

namespace {
constexpr double kLeastRate_hz = 1e-6;  // whose period still is a number of nanoseconds
}

FrameCadence::FrameCadence(boost::asio::io_context& context, std::function<void()> on_due)
    : on_due_(std::move(on_due)), timer_(context) {}

void FrameCadence::Set(double rate_hz) {
  timer_.cancel();
  ++wait_;
  every_ = std::chrono::nanoseconds(rate_hz > 0 ? std::llround(1e9 / std::max(rate_hz, kLeastRate_hz)) : 0);
  due_ = rate_hz > 0;
  taken_ = nullptr;
  if (!due_) return;
  Await(every_);
  on_due_();
}

void FrameCadence::Pause(std::chrono::nanoseconds pause) {
  if (every_.count() == 0) return;
  due_ = false;
  Await(std::max(every_, pause));
}

void FrameCadence::Postpone(std::chrono::nanoseconds pause) {
  taken_ = nullptr;
  Pause(pause);
}

FramePtr FrameCadence::Take(const FrameBoard& frames) {
  if (!due_) return nullptr;
  due_ = false;
  FramePtr frame = frames.Latest();
  if (frame == taken_) return nullptr;
  taken_ = frame;
  return frame;
}

void FrameCadence::Await(std::chrono::nanoseconds pause) {
  timer_.expires_after(pause);
  timer_.async_wait([this, alive = std::weak_ptr(alive_), wait = ++wait_](boost::system::error_code failed) {
    if (failed || alive.expired() || wait != wait_) return;
    due_ = true;
    on_due_();
    if (wait == wait_) Await(every_);
  });
}

}  // namespace coopdyn
