// SPDX-License-Identifier: MIT
#include "server/physics/part.h"

namespace coopdyn {

PlacedPart::PlacedPart(const Part& of, const BodyState& body) : part(&of) {
  for (int row = 0; row < 3; ++row) {
    const double* r = body.R_WB.data() + 3 * row;
    p[row] = body.p_WB[row] + r[0] * of.p_BG.x() + r[1] * of.p_BG.y() + r[2] * of.p_BG.z();
    for (int column = 0; column < 3; ++column) {
      R[4 * row + column] = r[0] * of.R_BG(0, column) + r[1] * of.R_BG(1, column) + r[2] * of.R_BG(2, column);
    }
    R[4 * row + 3] = 0;
  }
  if (const Box* box = std::get_if<Box>(&of.shape)) {
    for (int row = 0; row < 3; ++row) {
      const double* r = R + 4 * row;
      half_m[row] = (std::abs(r[0]) * box->size_m.x() + std::abs(r[1]) * box->size_m.y() +
                     std::abs(r[2]) * box->size_m.z()) /
                    2;
    }
  } else if (const Cylinder* cylinder = std::get_if<Cylinder>(&of.shape)) {
    for (int row = 0; row < 3; ++row) {
      const double along = std::abs(R[4 * row + 2]);
      half_m[row] =
          along * cylinder->length_m / 2 + std::sqrt(std::max(0.0, 1 - along * along)) * cylinder->radius_m;
    }
  } else {
    half_m.setConstant(std::get<Sphere>(of.shape).radius_m);
  }
}

}  // namespace coopdyn
