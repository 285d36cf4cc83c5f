// SPDX-License-Identifier: MIT
// From a frame to the readings of controllers: only what each asks for. The stepping thread; the work is
// shared out to a pool, and does not depend on how many threads it has.
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

/// A robot whose readings are wanted.
struct ReadingsWanted {
  std::uint32_t slot = 0;                     // its number in the set
  int robot = 0;                              // index into the scene; kSupervisor: of nothing but the world
  std::uint32_t readings = 0;                 // of enum coopdyn_reading
  std::span<const std::size_t> sensors = {};  // COOPDYN_SENSORS: index into the model's
};

/// A picture of a camera that is wanted: width × height × 3 bytes.
struct PictureWanted {
  CameraShot shot;
  std::span<std::uint8_t> rgb;
};
/// Draws them all, and returns when they are there: why some could not be drawn, and are black. The stepping
/// thread.
using DrawPictures = std::function<std::string(std::span<const PictureWanted> wanted)>;
/// By the render thread that serves `images`, which outlives it.
DrawPictures DrawOn(ImageBoard& images);

class ReadingsWriter {
 public:
  ReadingsWriter(WorkerPool& pool, DrawPictures draw) : pool_(pool), draw_(std::move(draw)) {}

  /// Writes the readings of `wanted` in `frame` into the areas of `set`. Returns why pictures are missing.
  std::string Write(const FramePtr& frame, std::span<const ReadingsWanted> wanted, ControllerSet& set);

 private:
  /// Readings of which there is no fixed number. Kept from step to step for their memory.
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
  /// Lists all that a supervisor sees.
  void CollectWorld(const Frame& frame);
  /// Gives all lists a place behind what is laid out, and copies them there.
  void PlaceLists(std::span<const ReadingsWanted> wanted, ControllerSet& set);

  WorkerPool& pool_;
  const DrawPictures draw_;              // null: there are none
  std::vector<PictureWanted> pictures_;  // kept for their memory
  std::vector<int> robots_;              // that need their distances
  std::vector<Lists> lists_;             // as `wanted`
  std::vector<coopdyn_body> bodies_;     // of the world, for a supervisor
  std::vector<coopdyn_score> scores_;
};

}  // namespace coopdyn
