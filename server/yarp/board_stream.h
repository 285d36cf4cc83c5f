// SPDX-License-Identifier: MIT
// The streams of a YARP control board: state:o, the positions, and stateExt:o, the complete state for its
// clients. Pure; one thread.
//
// The layout follows jointData.thrift of YARP 3.12 (22 fields) and 4.0 (24).
#pragma once

#include <string>
#include <vector>

#include "server/yarp/board.h"
#include "server/yarp/bottle.h"

namespace coopdyn {

/// The samples of one connection: accelerations are differences between samples.
class BoardSampler {
 public:
  /// Appends the bytes of stateExt:o.
  void AppendState(const BoardState& state, YarpDialect dialect, std::string& out);

 private:
  std::vector<double> velocities_;
  double time_s_ = 0;
};

/// The Vector of state:o: the positions.
Bottle BoardPositions(const BoardState& state);

}  // namespace coopdyn
