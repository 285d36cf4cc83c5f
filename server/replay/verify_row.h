// SPDX-License-Identifier: MIT
// Is what a recording shows of a step (poses, wheels, readings) what its state gives? Not thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "server/record/recorded_step.h"
#include "server/replay/verify.h"

namespace coopdyn {

class RowCheck {
 public:
  /// The first thing in `step` that is not what the writer makes of `repeated`, whose exact state is the
  /// recorded one. What was not recorded is not looked at.
  std::optional<Difference> Find(const RecordedStep& step, const Frame& repeated);

 private:
  std::optional<Difference> FindWheels(const RecordedStep& step, const Frame& repeated);
  std::optional<Difference> FindFloats(const std::vector<float>& recorded, const Frame& repeated,
                                       const char* reading);

  // Buffers that steps share.
  std::vector<std::byte> blob_;
  std::vector<BodyState> bodies_;
  std::vector<RobotState> robots_;
  std::vector<float> floats_;
};

}  // namespace coopdyn
