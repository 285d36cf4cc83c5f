// SPDX-License-Identifier: MIT
#include "server/model/stand_in.h"

#include <algorithm>

#include "server/base/portable_math.h"
#include "server/geometry/shape.h"
#include "server/model/values.h"

namespace coopdyn {

std::optional<StandIn> StandIn::Of(const XmlNode& link) {
  const XmlNode* inertial = link.Child("inertial");
  const XmlNode* inertia = inertial == nullptr ? nullptr : inertial->Child("inertia");
  if (inertia == nullptr) return std::nullopt;
  const auto mass_kg = ParsePlain(inertial->TextOf("mass")), xx = ParsePlain(inertia->TextOf("ixx")),
             yy = ParsePlain(inertia->TextOf("iyy")), zz = ParsePlain(inertia->TextOf("izz"));
  if (!mass_kg || !xx || !yy || !zz || !(*mass_kg > 0) || !(std::min({*xx, *yy, *zz}) > 0))
    return std::nullopt;
  // I_xx = m (b² + c²) / 12, and so on.
  constexpr double kThinnest_m = 1e-3, kLongest_m = 10;
  const Vector3 squares = 6 / *mass_kg * Vector3(*yy + *zz - *xx, *zz + *xx - *yy, *xx + *yy - *zz);
  Vector3 size = squares.cwiseMax(0).cwiseSqrt().cwiseMax(kThinnest_m).cwiseMin(kLongest_m);
  // Invented inertias may give a box of metres for some grams, lighter than air.
  constexpr double kLightest_kg_m3 = 1;
  const double density_kg_m3 = *mass_kg / size.prod();
  if (density_kg_m3 < kLightest_kg_m3)
    size = (size * portable::Cbrt(density_kg_m3 / kLightest_kg_m3)).cwiseMax(kThinnest_m);
  StandIn made;
  XmlNode& shape = made.shape_;
  shape = {"box", {}, "", {}, inertial->where};
  shape.Add("size", FormatNumber(size.x()) + " " + FormatNumber(size.y()) + " " + FormatNumber(size.z()));
  if (inertial->Child("pose") != nullptr) made.pose_ = *inertial->Child("pose");
  return made;
}

bool StandIn::PutInto(XmlNode& collision) {
  if (is_used_) return false;
  is_used_ = true;
  std::erase_if(collision.children, [](const XmlNode& one) { return one.name == "pose"; });
  if (pose_) collision.children.push_back(*pose_);
  collision.Child("geometry")->children = {shape_};
  return true;
}

}  // namespace coopdyn
