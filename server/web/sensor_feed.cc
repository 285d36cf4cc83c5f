// SPDX-License-Identifier: MIT
#include "server/web/sensor_feed.h"

namespace coopdyn {

SensorFeed::Given SensorFeed::Take(const FramePtr& frame, const Clock& clock) {
  if (message_ != nullptr && frame_.lock() == frame) return {message_, 0};
  const Nanoseconds now = clock.Now();
  if (message_ != nullptr && now < next_ && scene_.lock() == frame->scene) return {message_, next_ - now};
  message_ = std::make_shared<const std::string>(make_(*frame));
  frame_ = frame;
  scene_ = frame->scene;
  const Nanoseconds end = clock.Now();
  next_ = end + kPausePerTime * (end - now);
  return {message_, 0};
}

}  // namespace coopdyn
