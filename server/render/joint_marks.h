// SPDX-License-Identifier: MIT
// The joints of robots, for a picture that explains a model: an arrow along each axis that moves, in the
// colour of its type, and their names at the sides. Pure; any thread.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "server/render/overlay.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A name, and the pixel that it belongs to.
struct JointName {
  std::string text;
  double x_px = 0, y_px = 0;  // middle of its lower edge
  Color color;
  std::array<double, 2> at_px;
};

struct JointMarks {
  std::vector<OverlayVertex> arrows;  // drawn over everything
  std::vector<JointName> names;       // of as many joints as there is room for, those with motors first
  std::vector<JointName> legend;      // the types that are there; they point at nothing
};

JointMarks MarkJoints(const Frame& frame, const Frustum& frustum);

}  // namespace coopdyn
