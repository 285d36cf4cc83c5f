// SPDX-License-Identifier: MIT
// Draws a frame: sky, floor with its grid, lit shapes with their shadows, marks, sensor marks and names. Use
// and destroy it on the thread of its context.
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
  /// Null with `error` set if the driver cannot do it. `context` is current and must outlive the renderer.
  static std::unique_ptr<SceneRenderer> Create(const GlContext& context, std::string& error);
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// Draws the requested picture; empty if memory is short. @pre CheckImageRequest(request) is empty
  Picture Draw(const Frame& frame, const ImageRequest& request, const Camera& camera);

  /// Per pixel, row by row from the top: the depth along the view and the segmentation number.
  struct Numbers {
    std::vector<float> depth_m;          // inf: nothing
    std::vector<std::uint16_t> numbers;  // kFloorNumber, …; 0: nothing
  };
  /// Draws for a robot's camera with one sample per pixel. Empty if memory is short.
  Numbers DrawNumbers(const Frame& frame, const ImageRequest& request, const Camera& camera);

 private:
  struct Impl;
  explicit SceneRenderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace coopdyn
