// SPDX-License-Identifier: MIT
// The render thread. Sleeps until a picture is requested; paces streams to `fps` and makes single pictures at
// once.
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
  double fps = 10;  // of streams; kMinFps…kMaxFps
  /// Called once, on the render thread, when it can no longer draw; `text` says why.
  std::function<void(const std::string& text)> on_failure = {};

  static constexpr double kMinFps = 0.1, kMaxFps = 60;
};

class PictureMaker;

class RenderThread {
 public:
  /// Starts the thread. The boards and the clock must outlive it.
  RenderThread(ImageBoard& images, const FrameBoard& frames, const Clock& clock, RenderOptions options,
               Logger log);
  /// Calls Stop().
  ~RenderThread();
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  /// Ends the thread after the current picture; refuses pending and later requests.
  void Stop();

 private:
  void Run(std::stop_token stop);
  void Draw(const std::stop_token& stop);
  /// Draws and answers `taken`; answers all requests even if drawing throws.
  void Answer(std::vector<ImageBoard::Pending> taken, const std::stop_token& stop, PictureMaker& maker);
  ImageResult Make(const ImageRequest& request, const std::stop_token& stop, PictureMaker& maker);

  ImageBoard& images_;
  const FrameBoard& frames_;
  const Clock& clock_;
  const RenderOptions options_;
  const Logger log_;
  bool described_ = false;  // the renderer has been logged; render thread only
  std::jthread thread_;     // last: starts after all other members exist
};

}  // namespace coopdyn
