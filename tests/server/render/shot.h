// SPDX-License-Identifier: MIT
// Pictures for tests.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "server/render/camera.h"
#include "server/render/picture.h"
#include "server/render/picture_maker.h"

namespace coopdyn {

struct Pixel {
  int r, g, b;
  int brightness() const { return r + g + b; }
};

/// A picture of a view, whose pixels are looked up by world points.
class Shot {
 public:
  Shot(const Frame& frame, ImageRequest request, RendererKind renderer = RendererKind::kOsmesa)
      : request_(request), camera_(CameraFor(request, *frame.scene)) {
    request_.format = ImageFormat::kRgb;
    const ImageResult result = PictureMaker(renderer).Make(frame, request_);
    EXPECT_EQ(result.error, "");
    if (result.bytes) picture_ = {request.width, request.height, *result.bytes};
  }
  Pixel At(int x, int y) const {
    const std::uint8_t* p = picture_.at(x, y);
    return {p[0], p[1], p[2]};
  }
  Pixel At(const Vector3& p_W) const {
    const ProjectedPoint at = Frustum(camera_, request_.width, request_.height).Pixel(p_W);
    return At(static_cast<int>(at.x_px), static_cast<int>(at.y_px));
  }
  const Picture& picture() const { return picture_; }

 private:
  ImageRequest request_;
  Camera camera_;
  Picture picture_;
};

inline ImageRequest PictureFrom(const Vector3& eye, const Vector3& look) {
  ImageRequest request;
  request.width = 320;
  request.height = 240;
  request.eye_m = eye;
  request.look_m = look;
  return request;
}

}  // namespace coopdyn
