// SPDX-License-Identifier: MIT
// Pictures for the UI thread.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>

#include "server/state/frame_board.h"
#include "server/state/image_board.h"
#include "server/web/answers.h"

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
  Pictures(boost::asio::io_context& context, const FrameBoard& frames, ImageBoard* images)
      : frames_(frames), images_(images), answers_(context) {}

  bool available() const { return images_ != nullptr; }
  /// `done` is called once on the UI thread, later, unless Stop() came first. UI thread.
  void Request(ImageRequest request, std::function<void(const ImageResult&)> done) {
    const auto answer = answers_.Expect(std::move(done));
    if (images_ != nullptr) return images_->Request(std::move(request), answer);
    ImageResult none;
    none.error = "the daemon runs without pictures (--no-render)";
    answer(none);
  }
  /// What the newest frame shows. UI thread.
  SceneMoment moment() const {
    const FramePtr frame = frames_.Latest();
    return frame == nullptr ? SceneMoment() : SceneMoment{frame->epoch, frame->step, frame->revision};
  }
  /// No answer gets through any more, those that wait are forgotten. UI thread, or when that has stopped.
  void Stop() { answers_.Stop(); }

 private:
  const FrameBoard& frames_;
  ImageBoard* images_;
  Answers<ImageResult> answers_;
};

}  // namespace coopdyn
