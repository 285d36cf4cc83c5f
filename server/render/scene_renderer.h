// SPDX-License-Identifier: MIT
// Draws a frame: sky, floor with its grid, lit shapes with their shadows, marks, what sensors see and names.
// Used and destroyed on the thread of its context.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/render/draw_list.h"
#include "server/render/gl_context.h"
#include "server/render/picture.h"

namespace coopdyn {

class SceneRenderer {
 public:
  /// Null with `error` set if the driver cannot do it. `context` outlives it and is current.
  static std::unique_ptr<SceneRenderer> Create(const GlContext& context, std::string& error);
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// Draws what `request` asks for. @pre CheckImageRequest(request) is empty. An empty picture if memory is
  /// short.
  Picture Draw(const Frame& frame, const ImageRequest& request, const Camera& camera);

  /// Of each pixel, row by row from the top, the depth along the view and the number in a segmentation.
  struct Numbers {
    std::vector<float> depth_m;          // inf: nothing
    std::vector<std::uint16_t> numbers;  // kFloorNumber, …; 0: nothing
  };
  /// Draws for a robot's camera; one sample a pixel. Empty if memory is short.
  Numbers DrawNumbers(const Frame& frame, const ImageRequest& request, const Camera& camera);

 private:
  struct Impl;
  explicit SceneRenderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coopdyn
