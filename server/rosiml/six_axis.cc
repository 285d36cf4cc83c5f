// SPDX-License-Identifier: MIT
#include "server/rosiml/six_axis.h"

#include <algorithm>
#include <utility>

#include "server/base/printable.h"

namespace coopdyn::rosiml {

namespace {

/// A free axis `name`: x, y, z, rx, ry or rz.
Joint AxisCalled(const std::string& name) {
  Joint axis;
  axis.name = name;
  axis.kind = name.size() == 2 ? Joint::Kind::kHinge : Joint::Kind::kSlider;
  axis.counts_source = false;
  return axis;
}

/// Reads an axis of a <generic>. In YARS only its <deflection> limits the axis; an empty one leaves it free.
void ReadGenericAxis(const Element& element, bool has_spring, const std::string& what, Reader& reader,
                     Joint& axis) {
  const bool turns = axis.kind == Joint::Kind::kHinge;
  const Element& deflection = *Child(element, "deflection");
  const double unit = turns ? kRadPerDeg : 1;
  const double least = Number(deflection, "min", 0) * unit, most = Number(deflection, "max", 0) * unit;
  if (least <= most) axis.limit = {least, most};
  axis.line = element.GetLineNum();
  axis.counts_source = turns;  // angles in YARS are those of the source relative to the destination
  const bool is_active = Text(element, "mode") == "active";
  axis.max_effort = NumberIn(element, "force", "max", 0);
  axis.max_velocity = NumberIn(element, "velocity", "max", 0);
  axis.is_driven = is_active && axis.max_effort > 0 && axis.max_velocity > 0;
  if (is_active && !axis.is_driven)
    reader.Warn(element, what + " has no motor: its force and its velocity must be above 0");
  if (!is_active) axis.friction = Number(element, "friction", 0);
  if (!has_spring) return;
  axis.stiffness = NumberIn(element, "spring", "stiffness", 0);
  axis.damping = NumberIn(element, "spring", "damping", 0);
}

}  // namespace

std::vector<Joint> ReadGenericAxes(const Element& generic, Reader& reader) {
  const bool has_spring = Flag(generic, "spring", false);
  std::vector<Joint> axes;
  // The sliders are along the source's axes; the hinges follow in the order z, y, x.
  for (const char* name : {"x", "y", "z", "rz", "ry", "rx"}) {
    Joint axis = AxisCalled(name);
    const bool turns = axis.kind == Joint::Kind::kHinge;
    const Element* group = Child(generic, turns ? "rotational" : "translational");
    const Element* element = group == nullptr ? nullptr : Child(*group, turns ? name + 1 : name);
    if (element == nullptr) continue;
    const std::string what = "the axis '" + axis.name + "' of '" + Printable(Text(generic, "name")) + "'";
    if (Child(*element, "deflection") == nullptr) {
      if (Text(*element, "mode") == "active" || Child(*element, "spring") != nullptr)
        reader.Warn(*element, what + " is locked, as an axis without <deflection> is");
      continue;
    }
    ReadGenericAxis(*element, has_spring, what, reader, axis);
    axes.push_back(std::move(axis));
  }
  return axes;
}

std::vector<Joint> AxesOfType(std::string_view type) {
  std::vector<Joint> axes;
  if (type != "sixAxis") axes = {AxisCalled("rx"), AxisCalled("ry")};
  return axes;
}

Joint* FindAxis(std::vector<Joint>& axes, std::string_view type, const std::string& name) {
  const auto found = std::ranges::find(axes, name, &Joint::name);
  if (found != axes.end()) return &*found;
  // A wheel's suspension comes before its hinges.
  if (type == "hinge2" && name == "x") return &*axes.insert(axes.begin(), AxisCalled(name));
  if (type != "sixAxis") return nullptr;
  axes.push_back(AxisCalled(name));
  return &axes.back();
}

}  // namespace coopdyn::rosiml
