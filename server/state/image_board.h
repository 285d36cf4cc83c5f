// SPDX-License-Identifier: MIT
// Hands requests for pictures to the render thread, which sleeps while there are none.
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

inline constexpr int kMinImagePixels = 16;  // both ways
inline constexpr int kMaxImageWidth = 1920;
inline constexpr int kMaxImageHeight = 1080;

/// kRgb: three bytes a pixel, row by row from the top. Of robots' cameras only: kDepth, float32 in m along
/// the view, 0: too near, inf: nothing; kSegmentation, uint16: 0 nothing, 1 the floor, then objects, robots
/// and targets, each as in the scene. Both little-endian.
enum class ImageFormat { kPng, kJpeg, kRgb, kDepth, kSegmentation };
/// "image/png", "image/jpeg", "application/octet-stream"
const char* MediaType(ImageFormat format);

/// What of a robot's camera a picture for people (kPng, kJpeg, kRgb) shows: depths as greys, the nearest the
/// brightest, or a colour per number of the segmentation.
enum class ShotView { kColor, kDepth, kSegmentation };

/// A picture of a robot's camera.
struct CameraShot {
  FramePtr frame;          // that is drawn; null: the newest
  int robot = -1;          // index into the scene
  std::size_t sensor = 0;  // of its model: a camera
  ShotView view = ShotView::kColor;
  std::string robot_name = {}, module = {};  // instead of robot and sensor: looked up in the frame

  bool operator==(const CameraShot&) const = default;
};

/// What somebody wants to see.
struct ImageRequest {
  FramePtr frame = nullptr;        // that is drawn, unless there is a shot; null: the newest
  std::optional<CameraShot> shot;  // of a robot's camera: size, place and field of view are its own
  int width = 640;
  int height = 480;
  std::optional<Vector3> eye_m;   // in the world; neither eye nor look: the camera that frames the scene
  std::optional<Vector3> look_m;  // the point in the middle of the picture; missing: the middle of the scene
  double fov_rad = 0.8;           // full vertical angle
  ImageFormat format = ImageFormat::kPng;
  bool show_rays = false;    // and scans, cones and fields of view: what robots' sensors see
  bool show_names = true;    // of the robots
  bool show_joints = false;  // axes and names of all joints, over everything
  bool paced = false;        // one picture of a stream: waits for the next tick of --render-fps

  bool operator==(const ImageRequest&) const = default;
};

/// What is wrong with `request` and what to write instead; empty if nothing.
std::string CheckImageRequest(const ImageRequest& request);

/// The camera of a picture, so that a viewer can go on from there. Frame: world; m.
struct ImageCamera {
  Vector3 eye_m = Vector3::Zero();
  Vector3 look_m = Vector3::Zero();
};

struct ImageResult {
  std::string error;                                       // empty: there is a picture
  bool is_unknown = false;                                 // with an error: there is no such robot or camera
  std::shared_ptr<const std::vector<std::uint8_t>> bytes;  // encoded; null with an error
  int width = 0, height = 0;
  std::string legend = {};  // of a segmentation: what is seen, `1=floor 3=BOX_1`
  ImageCamera camera;
  std::uint64_t step = 0;  // of the frame shown
  std::uint64_t revision = 0;
  Nanoseconds time = 0;  // simulated
};

/// Called once per request, with no lock held: on the render thread, or, if the request never gets there, on
/// the thread that refused it. Posts to its own thread and returns.
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

  /// Asks for a picture. If too many wait, the oldest request of a stream gives way, else this one is
  /// refused. Any thread.
  void Request(ImageRequest request, ImageDone done) EXCLUDES(mutex_);

  /// Waits for requests and takes them: one-off ones at once, those of streams from `paced_from` of `clock`
  /// on, all of them together. Empty if `stop` came or the board was closed. Render thread only.
  std::vector<Pending> WaitAndTake(std::stop_token stop, const Clock& clock, Nanoseconds paced_from)
      EXCLUDES(mutex_);

  /// Request(), and waits until it is done. Any thread but the render thread.
  ImageResult Draw(ImageRequest request) EXCLUDES(mutex_);

  /// Refuses all that wait and all that come from now on, with `reason`. Any thread.
  void Close(const std::string& reason) EXCLUDES(mutex_);

 private:
  void TakeReady(bool paced_too, std::vector<Pending>& taken) REQUIRES(mutex_);

  Mutex mutex_;
  ConditionVariable arrived_;
  std::deque<Pending> waiting_ GUARDED_BY(mutex_);  // in the order of arrival
  bool closed_ GUARDED_BY(mutex_) = false;
  std::string close_reason_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
