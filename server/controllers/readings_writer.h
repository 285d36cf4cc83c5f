// SPDX-License-Identifier: MIT
// From a frame to the readings of controllers: only what each asks for. The stepping thread; the work is
// shared out to a pool, and does not depend on how many threads it has.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "clients/plugin/controller.h"
#include "server/base/worker_pool.h"
#include "server/controllers/controller_set.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A robot whose readings are wanted.
struct ReadingsWanted {
  std::uint32_t slot = 0;      // its number in the set
  int robot = 0;               // index into the scene
  std::uint32_t readings = 0;  // of enum coopdyn_reading
};

class ReadingsWriter {
 public:
  explicit ReadingsWriter(WorkerPool& pool) : pool_(pool) {}

  /// Writes the readings of `wanted` in `frame` into the areas of `set`.
  void Write(const Frame& frame, std::span<const ReadingsWanted> wanted, ControllerSet& set);

 private:
  /// Readings of which there is no fixed number. Kept from step to step for their memory.
  struct Lists {
    std::vector<coopdyn_target> targets;
    std::vector<coopdyn_sighting> neighbours;
    std::vector<coopdyn_heard> heard;
  };
  void WriteFixed(const Frame& frame, const ReadingsWanted& wanted, const Areas& areas) const;
  static void Collect(const Frame& frame, const ReadingsWanted& wanted, Lists& lists);
  /// Gives all lists a place behind what is laid out, and copies them there.
  void PlaceLists(std::span<const ReadingsWanted> wanted, ControllerSet& set);

  WorkerPool& pool_;
  std::vector<int> robots_;   // that need their distances
  std::vector<Lists> lists_;  // as `wanted`
};

}  // namespace coopdyn
