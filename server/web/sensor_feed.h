// SPDX-License-Identifier: MIT
// The sensor messages (sensor_message.h) of all pages: made once for all that ask for the same frame, and
// less often if making one takes long, so that any number of pages leaves the UI thread its time. One thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "server/base/clock.h"
#include "server/state/frame.h"
#include "server/web/sensor_message.h"

namespace coopdyn {

class SensorFeed {
 public:
  using Make = std::function<std::string(const Frame&)>;
  using Message = std::shared_ptr<const std::string>;

  explicit SensorFeed(Make make = [](const Frame& frame) { return SensorMessage(frame); })
      : make_(std::move(make)) {}

  struct Given {
    Message message;
    Nanoseconds wait = 0;  // not 0: this message is of an older frame; the next is made after so long
  };
  /// The message of `frame`, or that of an older frame of its scene, while it is too early to make another.
  Given Take(const FramePtr& frame, const Clock& clock);

 private:
  static constexpr int kPausePerTime = 4;  // a fifth of the thread's time at most

  Make make_;
  std::weak_ptr<const Frame> frame_;  // of the message
  std::weak_ptr<const Scene> scene_;  // likewise
  Message message_;
  Nanoseconds next_ = 0;  // may be made from then on
};

}  // namespace coopdyn
