// SPDX-License-Identifier: MIT
// The thread that draws. It sleeps until a picture is asked for; streams are paced to `fps`, single pictures
// made at once.
#pragma once

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/render/gl_context.h"
#include "server/state/frame_board.h"
#include "server/state/image_board.h"

namespace coopdyn {

struct RenderOptions {
  RendererKind renderer = RendererKind::kAuto;
  double fps = 10;  // of streams; from kMinFps to kMaxFps
  /// Called on the render thread, once, when it can draw no more; `text` says why.
  std::function<void(const std::string& text)> on_failure = {};

  static constexpr double kMinFps = 0.1, kMaxFps = 60;
};

class PictureMaker;

class RenderThread {
 public:
  /// Starts the thread. The boards and the clock outlive it.
  RenderThread(ImageBoard& images, const FrameBoard& frames, const Clock& clock, RenderOptions options,
               Logger log);
  /// Stops.
  ~RenderThread();
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  /// Ends the thread after the picture it is at; whatever still waits, or comes later, is refused.
  void Stop();

 private:
  void Run(std::stop_token stop);
  void Draw(const std::stop_token& stop);
  /// Draws and answers `taken`; if something throws, it answers all the same.
  void Answer(std::vector<ImageBoard::Pending> taken, const std::stop_token& stop, PictureMaker& maker);
  ImageResult Make(const ImageRequest& request, const std::stop_token& stop, PictureMaker& maker);

  ImageBoard& images_;
  const FrameBoard& frames_;
  const Clock& clock_;
  const RenderOptions options_;
  const Logger log_;
  bool described_ = false;  // what draws; the render thread's
  std::jthread thread_;     // last: the others live when it starts
};

}  // namespace coopdyn
