// SPDX-License-Identifier: MIT
// Writes controllers' readings of a frame: only those that each controller requests. Stepping thread;
// distributes the work to a pool, with results independent of its number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clients/plugin/controller.h"
#include "server/base/worker_pool.h"
#include "server/controllers/controller_set.h"
#include "server/state/frame.h"
#include "server/state/image_board.h"

namespace coopdyn {

/// A robot whose readings are requested.
struct ReadingsWanted {
  std::uint32_t slot = 0;                     // number in the set
  int robot = 0;                              // index into the scene; kSupervisor: only the world
  std::uint32_t readings = 0;                 // of enum coopdyn_reading
  std::span<const std::size_t> sensors = {};  // COOPDYN_SENSORS: indices into the model's sensors
};

/// A requested camera picture: width × height × 3 bytes.
struct PictureWanted {
  CameraShot shot;
  std::span<std::uint8_t> rgb;
};
/// Draws all pictures and waits for them. Pictures that could not be drawn are black; then returns the
/// reason. Stepping thread.
using DrawPictures = std::function<std::string(std::span<const PictureWanted> wanted)>;
/// Draws on the render thread that serves `images`. `images` must outlive the result.
DrawPictures DrawOn(ImageBoard& images);

class ReadingsWriter {
 public:
  ReadingsWriter(WorkerPool& pool, DrawPictures draw) : pool_(pool), draw_(std::move(draw)) {}

  /// Writes the readings of `wanted` in `frame` into the areas of `set`. Returns why pictures are missing.
  std::string Write(const FramePtr& frame, std::span<const ReadingsWanted> wanted, ControllerSet& set);

 private:
  /// Readings of variable number. Kept between steps to reuse their memory.
  struct Lists {
    std::vector<coopdyn_target> targets;
    std::vector<coopdyn_sighting> neighbours;
    std::vector<coopdyn_heard> heard;
  };
  static void WriteSensors(const Frame& frame, const ReadingsWanted& wanted, const Areas& areas);
  std::string WritePictures(const FramePtr& frame, std::span<const ReadingsWanted> wanted,
                            const Areas& areas);
  void WriteFixed(const Frame& frame, const ReadingsWanted& wanted, const Areas& areas) const;
  static void Collect(const Frame& frame, const ReadingsWanted& wanted, Lists& lists);
  /// Lists everything that a supervisor sees.
  void CollectWorld(const Frame& frame);
  /// Places all lists after the fixed layout and copies them there.
  void PlaceLists(std::span<const ReadingsWanted> wanted, ControllerSet& set);

  WorkerPool& pool_;
  const DrawPictures draw_;              // null: no pictures
  std::vector<PictureWanted> pictures_;  // kept to reuse memory
  std::vector<int> robots_;              // robots that need distances
  std::vector<Lists> lists_;             // parallel to `wanted`
  std::vector<coopdyn_body> bodies_;     // of the world, for a supervisor
  std::vector<coopdyn_score> scores_;
};

}  // namespace coopdyn
