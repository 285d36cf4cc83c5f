// SPDX-License-Identifier: MIT
// Marks robots' joints in a picture that explains a model: an arrow along each movable axis, coloured by
// joint type, and names at the sides. Pure; any thread.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "server/render/overlay.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A name and the pixel that it points to.
struct JointName {
  std::string text;
  double x_px = 0, y_px = 0;  // middle of the lower edge
  Color color;
  std::array<double, 2> at_px;
};

struct JointMarks {
  std::vector<OverlayVertex> arrows;  // drawn over everything
  std::vector<JointName> names;       // of the joints that fit, joints with motors first
  std::vector<JointName> legend;      // the joint types in the picture; point to nothing
};

JointMarks MarkJoints(const Frame& frame, const Frustum& frustum);

}  // namespace coopdyn
