// SPDX-License-Identifier: MIT
#include "server/render/picture_maker.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "server/render/camera.h"
#include "server/render/picture.h"

namespace coopdyn {

namespace {

std::string Describe(const GlContext& context) {
  const auto text = [&](GLenum name) {
    const GLubyte* value = context.gl().GetString(name);
    return value ? std::string(reinterpret_cast<const char*>(value)) : std::string();
  };
  const std::string library = context.kind() == RendererKind::kOsmesa ? "OSMesa" : "EGL";
  return library + ", " + text(GL_RENDERER) + ", GL " + text(GL_VERSION);
}

std::optional<std::vector<std::uint8_t>> Encode(Picture picture, ImageFormat format, int jpeg_quality) {
  switch (format) {
    case ImageFormat::kPng:
      return EncodePng(picture);
    case ImageFormat::kJpeg:
      return EncodeJpeg(picture, jpeg_quality);
    case ImageFormat::kRgb:
    case ImageFormat::kDepth:
    case ImageFormat::kSegmentation:
      break;
  }
  return std::move(picture.rgb);
}

}  // namespace

bool PictureMaker::Start() {
  if (started_) return scene_renderer_ != nullptr;
  started_ = true;
  context_ = GlContext::Create(renderer_, start_error_);
  if (context_) {
    description_ = Describe(*context_);
    scene_renderer_ = SceneRenderer::Create(*context_, start_error_);
    if (!scene_renderer_) context_.reset();
  }
  if (!scene_renderer_) {
    start_error_ = "no pictures: " + start_error_;
    description_ = start_error_;
  }
  return scene_renderer_ != nullptr;
}

ImageResult PictureMaker::Make(const Frame& frame, const ImageRequest& request) {
  ImageRequest key = request;
  key.paced = false;
  const FrameName name{frame.epoch, frame.step, frame.revision};
  if (name != kept_frame_) kept_.clear();
  kept_frame_ = name;
  for (const Kept& kept : kept_) {
    if (kept.request == key) return kept.result;
  }
  ImageResult result;
  result.step = frame.step;
  result.revision = frame.revision;
  result.time = frame.time;
  result.error = CheckImageRequest(request);
  if (result.error.empty() && !Start()) result.error = start_error_;
  if (result.error.empty() && request.shot) result.error = "the pictures of cameras are not drawn yet";
  if (result.error.empty()) Draw(frame, request, result);
  if (!result.error.empty()) return result;
  if (kept_.size() >= kMaxKept) kept_.erase(kept_.begin());
  kept_.push_back({key, result});
  return result;
}

void PictureMaker::Draw(const Frame& frame, const ImageRequest& request, ImageResult& result) {
  const Camera camera = CameraFor(request, *frame.scene);
  result.camera = {camera.eye_W, camera.look_W};
  Picture picture = scene_renderer_->Draw(frame, request, camera);
  ++drawn_;
  result.width = request.width;
  result.height = request.height;
  std::optional<std::vector<std::uint8_t>> bytes;
  if (!picture.rgb.empty()) bytes = Encode(std::move(picture), request.format, kJpegQuality);
  if (!bytes) {
    result.error = "no memory for a picture of this size: ask for a smaller one";
    return;
  }
  result.bytes = std::make_shared<const std::vector<std::uint8_t>>(std::move(*bytes));
}

std::optional<std::string> RenderPicture(const Frame& frame, const ImageRequest& request,
                                         RendererKind renderer, const std::string& path) {
  ImageRequest in_format = request;
  const bool is_jpeg = path.ends_with(".jpg") || path.ends_with(".jpeg");
  if (!is_jpeg && !path.ends_with(".png")) return path + ": write a file name that ends in .png or .jpg";
  in_format.format = is_jpeg ? ImageFormat::kJpeg : ImageFormat::kPng;
  PictureMaker maker(renderer);
  const ImageResult result = maker.Make(frame, in_format);
  if (!result.error.empty()) return result.error;
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(result.bytes->data()),
             static_cast<std::streamsize>(result.bytes->size()));
  file.close();
  if (!file) return path + ": cannot be written: " + (errno ? std::strerror(errno) : "the disk may be full");
  return std::nullopt;
}

}  // namespace coopdyn
