// SPDX-License-Identifier: MIT
// Requests pictures for the UI thread.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>

#include "server/state/frame_board.h"
#include "server/state/image_board.h"
#include "server/web/answers.h"

namespace coopdyn {

/// Identifies a state of the world.
struct SceneMoment {
  std::uint64_t epoch = 0;
  std::uint64_t step = 0;
  std::uint64_t revision = 0;
  bool operator==(const SceneMoment&) const = default;
};

class Pictures {
 public:
  /// `images`: null without rendering. All outlive this object.
  Pictures(boost::asio::io_context& context, const FrameBoard& frames, ImageBoard* images)
      : frames_(frames), images_(images), answers_(context) {}

  bool available() const { return images_ != nullptr; }
  /// Calls `done` once, later, on the UI thread, unless Stop() comes first. UI thread.
  void Request(ImageRequest request, std::function<void(const ImageResult&)> done) {
    const auto answer = answers_.Expect(std::move(done));
    if (images_ != nullptr) return images_->Request(std::move(request), answer);
    ImageResult none;
    none.error = "the daemon runs without pictures (--no-render)";
    answer(none);
  }
  /// The moment of the newest frame. UI thread.
  SceneMoment moment() const {
    const FramePtr frame = frames_.Latest();
    return frame == nullptr ? SceneMoment() : SceneMoment{frame->epoch, frame->step, frame->revision};
  }
  /// Drops all further answers. UI thread, or after that thread has stopped.
  void Stop() { answers_.Stop(); }

 private:
  const FrameBoard& frames_;
  ImageBoard* images_;
  Answers<ImageResult> answers_;
};

}  // namespace coopdyn
