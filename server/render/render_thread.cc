// SPDX-License-Identifier: MIT
#include "server/render/render_thread.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "server/render/picture_maker.h"

namespace coopdyn {

namespace {

constexpr const char* kFailed = "no more pictures are drawn, as drawing has failed";

ImageResult Failed(const char* why) {
  ImageResult result;
  result.error = why;
  return result;
}

}  // namespace

RenderThread::RenderThread(ImageBoard& images, const FrameBoard& frames, const Clock& clock,
                           RenderOptions options, Logger log)
    : images_(images),
      frames_(frames),
      clock_(clock),
      options_(std::move(options)),
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
  try {
    Draw(stop);
  } catch (const std::exception& error) {
    const std::string text =
        fmt::format("{}: {}. Start the daemon again to have pictures", kFailed, error.what());
    log_->error("{}", text);
    images_.Close(text);
    if (options_.on_failure) options_.on_failure(text);
  }
}

void RenderThread::Draw(const std::stop_token& stop) {
  const double fps = std::clamp(options_.fps, RenderOptions::kMinFps, RenderOptions::kMaxFps);
  const auto period = static_cast<Nanoseconds>(std::llround(kNanosecondsPerSecond / fps));
  PictureMaker maker(options_.renderer);
  Nanoseconds paced_from = clock_.Now();
  while (!stop.stop_requested()) {
    std::vector<ImageBoard::Pending> taken = images_.WaitAndTake(stop, clock_, paced_from);
    const bool has_stream =
        std::any_of(taken.begin(), taken.end(), [](const auto& p) { return p.request.paced; });
    // Missed ticks are not made up.
    if (has_stream) paced_from = std::max(paced_from + period, clock_.Now());
    Answer(std::move(taken), stop, maker);
  }
}

void RenderThread::Answer(std::vector<ImageBoard::Pending> taken, const std::stop_token& stop,
                          PictureMaker& maker) {
  std::size_t next = 0;
  try {
    for (; next < taken.size(); ++next) {
      const ImageResult result = Make(taken[next].request, stop, maker);
      std::exchange(taken[next].done, {})(result);
    }
  } catch (...) {
    for (; next < taken.size(); ++next) {
      if (taken[next].done) taken[next].done(Failed(kFailed));
    }
    throw;
  }
}

ImageResult RenderThread::Make(const ImageRequest& request, const std::stop_token& stop,
                               PictureMaker& maker) {
  const FramePtr& given = request.shot ? request.shot->frame : request.frame;
  const FramePtr frame = given != nullptr ? given : frames_.Latest();
  if (stop.stop_requested()) return Failed("the simulator is stopping");
  if (!frame) return Failed("the world is not there yet: ask again in a moment");
  ImageResult result = maker.Make(*frame, request);
  if (!maker.description().empty() && !std::exchange(described_, true)) {
    if (maker.has_context()) {
      log_->info("pictures by {}", maker.description());
    } else {
      log_->warn("{}", maker.description());
    }
  }
  return result;
}

}  // namespace coopdyn
