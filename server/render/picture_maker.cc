// SPDX-License-Identifier: MIT
#include "server/render/picture_maker.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <span>
#include <utility>

#include "server/model/values.h"
#include "server/render/camera.h"
#include "server/render/lens.h"
#include "server/render/picture.h"
#include "server/sensing/readings.h"
#include "server/state/pose_codec.h"

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

/// Looks up the names of `shot`. Returns an error text if `frame` has no such camera, else empty.
std::string Find(const Frame& frame, CameraShot& shot) {
  const std::vector<SceneRobot>& robots = frame.scene->robots;
  if (!shot.robot_name.empty()) {
    shot.robot = frame.scene->FindRobot(shot.robot_name);
    if (shot.robot < 0) {
      std::vector<std::string> names;
      for (const SceneRobot& robot : robots) names.push_back(robot.entry.name);
      return "there is no robot '" + shot.robot_name + "'" + DidYouMean(shot.robot_name, names);
    }
    const std::vector<SensorModel>& sensors = ModelOf(frame, shot.robot).sensors;
    const auto found = std::ranges::find(sensors, shot.module, &SensorModel::name);
    shot.sensor = static_cast<std::size_t>(found - sensors.begin());
    if (found == sensors.end() || !std::holds_alternative<CameraModel>(found->kind)) {
      std::vector<std::string> names;
      for (const SensorModel& sensor : sensors) {
        if (std::holds_alternative<CameraModel>(sensor.kind)) names.push_back(sensor.name);
      }
      if (names.empty()) return shot.robot_name + " has no camera";
      return shot.robot_name + " has no camera '" + shot.module + "'" + DidYouMean(shot.module, names);
    }
  }
  if (shot.robot < 0 || static_cast<std::size_t>(shot.robot) >= robots.size())
    return "the robot is no longer part of the scenario";
  const RobotModel& model = *robots[static_cast<std::size_t>(shot.robot)].entry.model;
  if (shot.sensor < model.sensors.size() &&
      std::holds_alternative<CameraModel>(model.sensors[shot.sensor].kind))
    return {};
  return "the robot has no such camera";
}

template <typename Value>
std::vector<std::uint8_t> BytesOf(const std::vector<Value>& values) {
  static_assert(std::endian::native == std::endian::little);
  const auto bytes = std::as_bytes(std::span(values));
  std::vector<std::uint8_t> copy(bytes.size());
  std::memcpy(copy.data(), bytes.data(), bytes.size());
  return copy;
}

/// The legend of the numbers in the picture: `1=floor 3=BOX_1`.
std::string LegendOf(const std::vector<std::uint16_t>& numbers, const Scene& scene) {
  std::vector<std::uint16_t> there = numbers;
  std::ranges::sort(there);
  there.erase(std::unique(there.begin(), there.end()), there.end());
  std::string legend;
  for (const std::uint16_t number : there) {
    if (number == 0) continue;
    std::size_t place = static_cast<std::size_t>(number) - kFirstNumber;
    std::string name = "floor";
    if (number != kFloorNumber) {
      if (place < scene.objects.size()) {
        name = scene.objects[place].object.name;
      } else if ((place -= scene.objects.size()) < scene.robots.size()) {
        name = scene.robots[place].entry.name;
      } else {
        const Target& target = scene.targets[place - scene.robots.size()];
        name = target.color_name + "_target_" + std::to_string(target.id.value);
      }
    }
    legend += (legend.empty() ? "" : " ") + std::to_string(number) + "=" + name;
  }
  return legend;
}

/// Depths as a grey picture: the nearest is white, no depth is black.
Picture GreysOf(const std::vector<float>& depth_m, int width, int height) {
  Picture picture{width, height, std::vector<std::uint8_t>(3 * depth_m.size())};
  float nearest_m = std::numeric_limits<float>::infinity();
  for (const float depth : depth_m) nearest_m = depth > 0 ? std::min(nearest_m, depth) : nearest_m;
  for (std::size_t i = 0; i < depth_m.size(); ++i) {
    const bool is_there = depth_m[i] > 0 && std::isfinite(depth_m[i]);
    const auto grey = static_cast<std::uint8_t>(is_there ? 255 * std::sqrt(nearest_m / depth_m[i]) : 0);
    std::fill_n(picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, grey);
  }
  return picture;
}

/// A colour per number.
Picture ColorsOf(const std::vector<std::uint16_t>& numbers, int width, int height) {
  Picture picture{width, height, std::vector<std::uint8_t>(3 * numbers.size())};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::uint32_t mixed = numbers[i] * 2654435761u;  // Knuth's hash: adjacent numbers differ clearly
    for (std::size_t k = 0; k < 3 && numbers[i] > 0; ++k)
      picture.rgb[3 * i + k] = static_cast<std::uint8_t>(64 + ((mixed >> (8 * k + 8)) & 0xff) * 3 / 4);
  }
  return picture;
}

}  // namespace

void PictureMaker::DrawShot(const Frame& frame, const ImageRequest& request, ImageResult& result) {
  const CameraShot& shot = *request.shot;
  const SceneRobot& robot = frame.scene->robots[static_cast<std::size_t>(shot.robot)];
  const auto& model = std::get<CameraModel>(robot.entry.model->sensors[shot.sensor].kind);
  const bool is_kept = recorded_ != nullptr && recorded_->epoch == frame.epoch &&
                       recorded_->step == frame.step && recorded_->revision == frame.revision &&
                       recorded_->scene == frame.scene;
  if (!is_kept) recorded_ = AsRecorded(frame);
  ImageRequest sized = request;
  sized.width = result.width = model.width;
  sized.height = result.height = model.height;
  const Camera camera = CameraOf(*recorded_, shot.robot, shot.sensor);
  NoiseKey key{frame.seed,     NoiseKind::kCameraColor,
               robot.id.value, static_cast<std::uint32_t>(robot.entry.model->NumberOf(shot.sensor) + 1),
               frame.step,     0};
  ++drawn_;
  Picture picture;
  std::optional<std::vector<std::uint8_t>> bytes;
  const bool is_segmentation =
      request.format == ImageFormat::kSegmentation || shot.view == ShotView::kSegmentation;
  if (request.format == ImageFormat::kDepth || is_segmentation || shot.view == ShotView::kDepth) {
    SceneRenderer::Numbers numbers = scene_renderer_->DrawNumbers(*recorded_, sized, camera);
    key.kind = NoiseKind::kCameraDepth;
    AddNoise(model.depth_noise, key, numbers.depth_m);
    if (request.format == ImageFormat::kDepth) {
      bytes = BytesOf(numbers.depth_m);
    } else if (request.format == ImageFormat::kSegmentation) {
      bytes = BytesOf(numbers.numbers);
      result.legend = LegendOf(numbers.numbers, *frame.scene);
    } else {
      picture = is_segmentation ? ColorsOf(numbers.numbers, model.width, model.height)
                                : GreysOf(numbers.depth_m, model.width, model.height);
    }
    if (numbers.depth_m.empty()) bytes.reset();
  } else {
    picture = scene_renderer_->Draw(*recorded_, sized, camera);
    AddNoise(model.noise, key, picture);
  }
  if (!picture.rgb.empty()) bytes = Encode(std::move(picture), request.format, kJpegQuality);
  if (!bytes) {
    result.error = "no memory for a picture of this size: give the camera fewer pixels";
    return;
  }
  result.bytes = std::make_shared<const std::vector<std::uint8_t>>(std::move(*bytes));
}

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

ImageResult PictureMaker::Make(const Frame& newest, const ImageRequest& asked) {
  ImageRequest request = asked;
  if (request.shot) {
    ImageResult none;
    none.error = Find(newest, *request.shot);
    none.is_unknown = true;
    if (!none.error.empty()) return none;
  }
  const bool is_live = request.shot && request.shot->frame == nullptr;
  const Frame& frame = is_live ? SampleOf(newest, request.shot->robot, request.shot->sensor) : newest;
  ImageRequest key = request;
  key.paced = false;
  const FrameName name{frame.epoch, frame.step, frame.revision};
  const bool keeps = request.frame == nullptr;  // else the frame belongs to another world
  if (keeps && name != kept_frame_) kept_.clear();
  if (keeps) kept_frame_ = name;
  for (const Kept& kept : kept_) {
    if (kept.request == key) return kept.result;
  }
  ImageResult result;
  result.step = frame.step;
  result.revision = frame.revision;
  result.time = frame.time;
  result.error = CheckImageRequest(request);
  if (result.error.empty() && !Start()) result.error = start_error_;
  if (result.error.empty()) request.shot ? DrawShot(frame, request, result) : Draw(frame, request, result);
  if (!result.error.empty() || !keeps) return result;
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
