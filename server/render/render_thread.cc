// SPDX-License-Identifier: MIT
#include "server/render/render_thread.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/render/picture_maker.h"

namespace coopdyn {

RenderThread::RenderThread(ImageBoard& images, const FrameBoard& frames, const Clock& clock,
                           RenderOptions options, Logger log)
    : images_(images),
      frames_(frames),
      clock_(clock),
      options_(options),
      log_(std::move(log)),
      thread_([this](std::stop_token stop) { Run(std::move(stop)); }) {}

RenderThread::~RenderThread() {
  Stop();
}

void RenderThread::Stop() {
  thread_.request_stop();
  images_.Close("the simulator is stopping");
  if (thread_.joinable()) thread_.join();
}

void RenderThread::Run(std::stop_token stop) {
  const double fps = std::clamp(options_.fps, RenderOptions::kMinFps, RenderOptions::kMaxFps);
  const auto period = static_cast<Nanoseconds>(std::llround(kNanosecondsPerSecond / fps));
  PictureMaker maker(options_.renderer);
  Nanoseconds paced_from = clock_.Now();
  bool described = false;
  while (!stop.stop_requested()) {
    const std::vector<ImageBoard::Pending> taken = images_.WaitAndTake(stop, clock_, paced_from);
    const bool has_stream =
        std::any_of(taken.begin(), taken.end(), [](const auto& p) { return p.request.paced; });
    // A tick that was missed is not made up for.
    if (has_stream) paced_from = std::max(paced_from + period, clock_.Now());
    for (const ImageBoard::Pending& pending : taken) {
      ImageResult result;
      const std::optional<CameraShot>& shot = pending.request.shot;
      const FramePtr& given = shot ? shot->frame : pending.request.frame;
      const FramePtr frame = given != nullptr ? given : frames_.Latest();
      if (stop.stop_requested()) {
        result.error = "the simulator is stopping";
      } else if (!frame) {
        result.error = "the world is not there yet: ask again in a moment";
      } else {
        result = maker.Make(*frame, pending.request);
      }
      if (!described && !maker.description().empty()) {
        described = true;
        if (maker.has_context()) {
          log_->info("pictures by {}", maker.description());
        } else {
          log_->warn("{}", maker.description());
        }
      }
      pending.done(result);
    }
  }
}

}  // namespace coopdyn
