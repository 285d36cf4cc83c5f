// SPDX-License-Identifier: MIT
// Pictures for the UI thread: the render thread's answers are brought here, or dropped once the UI has
// stopped.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>

#include "server/state/frame_board.h"
#include "server/state/image_board.h"

namespace coopdyn {

/// Which state of the world is to be seen.
struct SceneMoment {
  std::uint64_t epoch = 0;
  std::uint64_t step = 0;
  std::uint64_t revision = 0;
  bool operator==(const SceneMoment&) const = default;
};

class Pictures {
 public:
  /// `images`: null without rendering. All outlive it.
  Pictures(boost::asio::io_context& context, const FrameBoard& frames, ImageBoard* images);
  /// Stop().
  ~Pictures();
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;

  bool available() const { return images_ != nullptr; }
  /// `done` is called once on the UI thread, later, unless Stop() came first. UI thread.
  void Request(ImageRequest request, std::function<void(const ImageResult&)> done);
  /// What the newest frame shows. UI thread.
  SceneMoment moment() const;
  /// No answer gets through any more, those that wait are forgotten. UI thread, or when that has stopped.
  void Stop();

 private:
  class Mailbox;
  void Deliver(std::uint64_t ticket, const ImageResult& result);

  const FrameBoard& frames_;
  ImageBoard* images_;
  std::shared_ptr<Mailbox> mailbox_;
  // Kept here, not with the render thread: what they hold must not outlive the UI thread's context.
  std::unordered_map<std::uint64_t, std::function<void(const ImageResult&)>> waiting_;
  std::uint64_t last_ticket_ = 0;
};

}  // namespace coopdyn
