// SPDX-License-Identifier: MIT
// Turns image requests into encoded bytes: makes the GL context at the first picture and caches the pictures
// of the newest frame. Use and destroy it on one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/render/gl_context.h"
#include "server/render/scene_renderer.h"

namespace coopdyn {

class PictureMaker {
 public:
  explicit PictureMaker(RendererKind renderer) : renderer_(renderer) {}

  /// The requested picture of `frame`, or an error; missing GL is an error, not an exception.
  ImageResult Make(const Frame& frame, const ImageRequest& request);

  /// Empty before the first picture; then e.g. "OSMesa, llvmpipe (…)", or why there is no renderer.
  const std::string& description() const { return description_; }
  bool has_context() const { return context_ != nullptr; }
  /// Number of pictures drawn, excluding cached ones.
  std::int64_t drawn() const { return drawn_; }

 private:
  static constexpr std::size_t kMaxKept = 8;
  static constexpr int kJpegQuality = 85;

  struct FrameName {
    std::uint64_t epoch = 0, step = 0, revision = 0;
    bool operator==(const FrameName&) const = default;
  };
  struct Kept {
    ImageRequest request;
    ImageResult result;
  };

  bool Start();
  /// Draws the picture of a robot's camera.
  void DrawShot(const Frame& frame, const ImageRequest& request, ImageResult& result);
  void Draw(const Frame& frame, const ImageRequest& request, ImageResult& result);

  const RendererKind renderer_;
  bool started_ = false;
  std::string start_error_;
  std::string description_;
  std::unique_ptr<GlContext> context_;
  std::unique_ptr<SceneRenderer> scene_renderer_;  // declared after context_: destroyed before it
  FramePtr recorded_;                              // the last frame that a camera showed, as recorded
  FrameName kept_frame_;
  std::vector<Kept> kept_;  // all show kept_frame_
  std::int64_t drawn_ = 0;
};

/// Writes the picture of `frame` to the file `path` as PNG (JPEG if it ends in .jpg or .jpeg). Returns the
/// error, or nullopt.
std::optional<std::string> RenderPicture(const Frame& frame, const ImageRequest& request,
                                         RendererKind renderer, const std::string& path);

}  // namespace coopdyn
