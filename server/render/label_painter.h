// SPDX-License-Identifier: MIT
// Paints names into a finished picture: light text on a dark plate with a stripe in the robot's colour. One
// thread.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "server/render/draw_list.h"
#include "server/render/picture.h"

namespace coopdyn {

class LabelPainter {
 public:
  /// Paints in the order given; the size follows the picture's height.
  void Paint(Picture& picture, const std::vector<Label>& labels);

 private:
  /// The coverage of each pixel by a character, 0…255. (left, top) is relative to the pen on the baseline.
  struct Mask {
    int left = 0, top = 0, width = 0, height = 0;
    double advance_px = 0;
    std::vector<unsigned char> cover;
  };
  const Mask& MaskOf(char c, double cap_px);
  void PaintOne(Picture& picture, const Label& label, double cap_px);

  std::map<std::pair<char, int>, Mask> masks_;  // by character and capital height in tenths of a pixel
};

}  // namespace coopdyn
