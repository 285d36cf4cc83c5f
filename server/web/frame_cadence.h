// SPDX-License-Identifier: MIT
// When a viewer gets the newest frame: at a rate of its choice, and each frame once. One thread.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

#include "server/state/frame_board.h"

namespace coopdyn {

class FrameCadence {
 public:
  /// Calls `on_due` whenever a frame may be taken.
  FrameCadence(boost::asio::io_context& context, std::function<void()> on_due);

  /// From now on; 0 stops. The next frame may be taken at once.
  void Set(double rate_hz);
  /// Delays the next frame by this much, if that is longer than the period.
  void Pause(std::chrono::nanoseconds pause);
  /// Likewise, and what was taken last counts as not taken.
  void Postpone(std::chrono::nanoseconds pause);
  /// The newest frame; null if none is due, or it was taken before.
  FramePtr Take(const FrameBoard& frames);

 private:
  void Await(std::chrono::nanoseconds pause);

  std::function<void()> on_due_;
  boost::asio::steady_timer timer_;
  std::chrono::nanoseconds every_{0};  // 0: stopped
  std::uint64_t wait_ = 0;             // number of the last wait, which replaced those before
  bool due_ = false;
  FramePtr taken_;
  std::shared_ptr<char> alive_ = std::make_shared<char>();  // expires with this object
};

}  // namespace coopdyn
