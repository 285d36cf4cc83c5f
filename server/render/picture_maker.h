// SPDX-License-Identifier: MIT
// From a request to encoded bytes: makes the GL context at the first picture, keeps the pictures of the
// newest frame. Used and destroyed on one thread.
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

  /// The picture of `frame` that `request` asks for, or an error; never throws for want of GL.
  ImageResult Make(const Frame& frame, const ImageRequest& request);

  /// Empty until the first picture was asked for; then "OSMesa, llvmpipe (…)" or the like, or why there is
  /// none.
  const std::string& description() const { return description_; }
  bool has_context() const { return context_ != nullptr; }
  /// How many pictures were drawn, not taken from those kept.
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
  /// What a robot's camera sees.
  void DrawShot(const Frame& frame, const ImageRequest& request, ImageResult& result);
  void Draw(const Frame& frame, const ImageRequest& request, ImageResult& result);

  const RendererKind renderer_;
  bool started_ = false;
  std::string start_error_;
  std::string description_;
  std::unique_ptr<GlContext> context_;
  std::unique_ptr<SceneRenderer> scene_renderer_;  // after context_: destroyed before it
  FramePtr recorded_;                              // of the frame that a camera has seen last
  FrameName kept_frame_;
  std::vector<Kept> kept_;  // all of kept_frame_
  std::int64_t drawn_ = 0;
};

/// Writes the picture of `frame` to the file `path` as PNG (or JPEG, if it ends in .jpg or .jpeg). Returns
/// what went wrong; nothing if it is there.
std::optional<std::string> RenderPicture(const Frame& frame, const ImageRequest& request,
                                         RendererKind renderer, const std::string& path);

}  // namespace coopdyn
