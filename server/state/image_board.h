// SPDX-License-Identifier: MIT
// Passes picture requests to the render thread, which sleeps while there are none.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/mutex.h"
#include "server/geometry/shape.h"
#include "server/state/frame.h"

namespace coopdyn {

inline constexpr int kMinImagePixels = 16;  // for width and height
inline constexpr int kMaxImageWidth = 1920;
inline constexpr int kMaxImageHeight = 1080;

/// kRgb: three bytes per pixel, row by row from the top. Robots' cameras only: kDepth, float32 in m along the
/// view, 0 if too near, inf if nothing; kSegmentation, uint16: 0 nothing, 1 the floor, then objects, robots
/// and targets in the scene's order. Both little-endian.
enum class ImageFormat { kPng, kJpeg, kRgb, kDepth, kSegmentation };
/// "image/png", "image/jpeg", "application/octet-stream"
const char* MediaType(ImageFormat format);

/// Content of a robot camera's picture in a format for people (kPng, kJpeg, kRgb). kDepth: greys, nearest
/// brightest; kSegmentation: a colour per number.
enum class ShotView { kColor, kDepth, kSegmentation };

/// A picture from a robot's camera.
struct CameraShot {
  FramePtr frame;          // frame to draw; null: the newest
  int robot = -1;          // index into the scene's robots
  std::size_t sensor = 0;  // index of the camera among the model's sensors
  ShotView view = ShotView::kColor;
  std::string robot_name = {}, module = {};  // if not empty, replace robot and sensor: looked up in the frame

  bool operator==(const CameraShot&) const = default;
};

/// A picture to draw.
struct ImageRequest {
  FramePtr frame = nullptr;        // frame to draw, unless there is a shot; null: the newest
  std::optional<CameraShot> shot;  // a robot's camera, which has its own size, place and field of view
  int width = 640;
  int height = 480;
  std::optional<Vector3> eye_m;   // in the world; with neither eye nor look the camera frames the scene
  std::optional<Vector3> look_m;  // the point at the picture's centre; nullopt: the middle of the scene
  double fov_rad = 0.8;           // full vertical angle
  ImageFormat format = ImageFormat::kPng;
  bool show_rays = false;    // and scans, cones and fields of view of robots' sensors
  bool show_names = true;    // of the robots
  bool show_joints = false;  // axes and names of all joints, drawn on top
  bool paced = false;        // part of a stream: waits for the next tick of --render-fps

  bool operator==(const ImageRequest&) const = default;
};

/// The error in `request` and how to correct it; empty if it is valid.
std::string CheckImageRequest(const ImageRequest& request);

/// A picture's camera, from which a viewer can continue. In the world frame; m.
struct ImageCamera {
  Vector3 eye_m = Vector3::Zero();
  Vector3 look_m = Vector3::Zero();
};

struct ImageResult {
  std::string error;                                       // empty: success
  bool is_unknown = false;                                 // error: no such robot or camera
  std::shared_ptr<const std::vector<std::uint8_t>> bytes;  // encoded; null with an error
  int width = 0, height = 0;
  std::string legend = {};  // of a segmentation: the visible things, `1=floor 3=BOX_1`
  ImageCamera camera;
  std::uint64_t step = 0;  // of the frame shown
  std::uint64_t revision = 0;
  Nanoseconds time = 0;  // simulated
};

/// Called once per request, without lock: on the render thread, or, if the request was refused, on the thread
/// that refused it. Posts to its own thread and returns.
using ImageDone = std::function<void(const ImageResult&)>;

/// Draws a picture and waits for it.
using DrawImage = std::function<ImageResult(ImageRequest request)>;

class ImageBoard {
 public:
  static constexpr std::size_t kMaxWaiting = 64;

  struct Pending {
    ImageRequest request;
    ImageDone done;
  };

  /// Requests a picture. If too many wait, refuses the oldest stream request, else this one. Any thread.
  void Request(ImageRequest request, ImageDone done) EXCLUDES(mutex_);

  /// Waits for requests and takes them: single ones at once, those of streams together once `clock` reaches
  /// `paced_from`. Empty after `stop` or Close(). Render thread only.
  std::vector<Pending> WaitAndTake(std::stop_token stop, const Clock& clock, Nanoseconds paced_from)
      EXCLUDES(mutex_);

  /// Request(), then waits for the result. Any thread but the render thread.
  ImageResult Draw(ImageRequest request) EXCLUDES(mutex_);

  /// Refuses all waiting and later requests with `reason`. Any thread.
  void Close(const std::string& reason) EXCLUDES(mutex_);

 private:
  void TakeReady(bool paced_too, std::vector<Pending>& taken) REQUIRES(mutex_);

  Mutex mutex_;
  ConditionVariable arrived_;
  std::deque<Pending> waiting_ GUARDED_BY(mutex_);  // by arrival
  bool closed_ GUARDED_BY(mutex_) = false;
  std::string close_reason_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
