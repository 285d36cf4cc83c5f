// SPDX-License-Identifier: MIT
// Is what a recording shows of a step (poses, channels, readings) what its state gives? Not thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "server/record/recorded_step.h"
#include "server/replay/verify.h"

namespace coopdyn {

class RowCheck {
 public:
  /// The first thing in `step` that is not what the writer makes of `repeated`, whose exact state is the
  /// recorded one. What was not recorded is not compared.
  std::optional<Difference> Find(const RecordedStep& step, const Frame& repeated);

 private:
  std::optional<Difference> FindMotion(const RecordedStep& step, const Frame& repeated);
  /// The place in `recorded` of the first reading that is not as in blob_.
  std::optional<std::size_t> FindReading(const std::vector<float>& recorded);
  std::optional<Difference> FindDistance(const std::vector<float>& recorded, const Frame& repeated);
  std::optional<Difference> FindTarget(const std::vector<float>& recorded, const Frame& repeated);
  /// Reading `place` of `recorded`, called `field`, which is one of `robot`.
  Difference ReadingDiffers(const std::vector<float>& recorded, const Frame& repeated, std::size_t place,
                            std::size_t robot, std::string field) const;

  // Buffers that steps share.
  std::vector<std::byte> blob_;
  std::vector<BodyState> bodies_;
  std::vector<ChannelMotion> channels_;
  std::vector<float> floats_;
};

}  // namespace coopdyn
