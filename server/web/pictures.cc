// SPDX-License-Identifier: MIT
#include "server/web/pictures.h"

namespace coopdyn {

Pictures::Pictures(boost::asio::io_context& context, const FrameBoard& frames, ImageBoard* images)
    : frames_(frames), images_(images), answers_(context) {}

void Pictures::Request(ImageRequest request, std::function<void(const ImageResult&)> done) {
  const auto answer = answers_.Expect(std::move(done));
  if (images_ != nullptr) return images_->Request(std::move(request), answer);
  ImageResult none;
  none.error = "the daemon runs without pictures (--no-render)";
  answer(none);
}

SceneMoment Pictures::moment() const {
  const FramePtr frame = frames_.Latest();
  if (!frame) return {};
  return {frame->epoch, frame->step, frame->revision};
}

}  // namespace coopdyn
