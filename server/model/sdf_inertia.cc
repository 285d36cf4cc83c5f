// SPDX-License-Identifier: MIT
// Reads masses and inertias of links, with defaults for missing ones in models made for other programs.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <ignition/math/Inertial.hh>
#include <sdf/sdf.hh>
#include <utility>

#include "server/model/model_source.h"
#include "server/model/sdf_body.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr double kLight_kg = 0.01;  // of a link without a mass
constexpr double kLeast_kg = 1e-9;

/// Sets mass and inertia of a link that has none, in a model made for other programs.
void GiveMass(double mass_kg, LinkModel& out) {
  out.mass_kg = mass_kg;
  out.X_LI = {};
  Shape shape = Sphere{0.05};
  const std::vector<LinkShape>& shapes = out.collisions.empty() ? out.visuals : out.collisions;
  if (!shapes.empty()) {
    shape = shapes.front().shape;
    out.X_LI = shapes.front().X_LG;
  }
  out.inertia_kg_m2 = SolidInertia(shape, mass_kg).cwiseMax(1e-7 * mass_kg);
}

bool HasMass(const sdf::Link& link) {
  return link.Element()->HasElement("inertial") && link.Inertial().MassMatrix().Mass() >= kLeast_kg;
}

std::string AttributeOf(const tinyxml2::XMLElement* element, const char* name) {
  const char* const value = element == nullptr ? nullptr : element->Attribute(name);
  return value == nullptr ? "" : value;
}

constexpr std::size_t kSolidValues = 5;  // of kSolidAttribute

}  // namespace

InertiaReader::InertiaReader(const std::vector<ModelScope>& scopes, ModelReading& reading)
    : reading_(reading) {
  std::set<std::string> heavy;
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const ModelScope& scope : scopes) {
    for (std::size_t i = 0; i < scope.model.LinkCount(); ++i) {
      const sdf::Link& link = *scope.model.LinkByIndex(i);
      if (HasMass(link)) heavy.insert(scope.prefix + link.Name());
    }
    for (std::size_t i = 0; i < scope.model.JointCount(); ++i) {
      const sdf::Joint& joint = *scope.model.JointByIndex(i);
      std::string parent, child;
      if (joint.Type() != sdf::JointType::FIXED || !joint.ResolveChildLink(child).empty()) continue;
      const bool parent_known = joint.ResolveParentLink(parent).empty();
      if (parent == "world") {
        still_.insert(scope.prefix + child);
      } else if (parent_known) {
        welded_.insert(scope.prefix + child);
        pairs.emplace_back(scope.prefix + parent, scope.prefix + child);
      }
    }
  }
  if (!reading.source.foreign) return;
  // A base without mass gets the mass of the links fixed to it.
  for (bool grows = true; grows;) {
    grows = false;
    for (const auto& [parent, child] : pairs) {
      if (!heavy.contains(child) || !heavy.insert(parent).second) continue;
      welded_.insert(parent);
      grows = true;
    }
  }
}

void InertiaReader::Read(const sdf::Link& link, const tinyxml2::XMLElement* xml, LinkModel& out) const {
  const tinyxml2::XMLElement* inertial = xml == nullptr ? nullptr : xml->FirstChildElement("inertial");
  if (inertial != nullptr && inertial->Attribute(kWeighAttribute) != nullptr) return Weigh(*xml, out);
  ReadInertial(link, inertial != nullptr && inertial->BoolAttribute("coopdyn:solid"), out);
}

void InertiaReader::Weigh(const tinyxml2::XMLElement& xml, LinkModel& out) const {
  constexpr double kMost = 1e5;
  const tinyxml2::XMLElement* collision = xml.FirstChildElement("collision");
  for (const LinkShape& shape : out.collisions) {
    const std::string word = AttributeOf(collision, kDensityAttribute);
    const auto density = ParsePlain(word);
    if (!density || !(*density > 0 && *density <= kMost))
      return reading_.Error(
          collision == nullptr ? xml.GetLineNum() : collision->GetLineNum(),
          "<density> must be a number above 0 and at most 100000 (kg/m³), not '" + word + "'");
    std::vector<double> solid;  // values of the solid that the mesh replaces
    for (const std::string& value : SplitWords(AttributeOf(collision, kSolidAttribute)))
      solid.push_back(ParsePlain(value).value_or(0));
    if (solid.size() == kSolidValues) {
      const double mass_kg = *density * solid[0];
      AddMass(mass_kg, mass_kg * Vector3(solid[1], solid[2], solid[3]),
              shape.X_LG * Pose{{0, 0, solid[4]}, Quaternion::Identity()}, out);
    } else if (const double mass_kg = *density * Volume(shape.shape); mass_kg > 0) {
      AddMass(mass_kg, SolidInertia(shape.shape, mass_kg), shape.X_LG, out);
    }
    collision = collision->NextSiblingElement("collision");
  }
  if (out.mass_kg > 0) return;
  reading_.Complain(xml.FirstChildElement("inertial")->GetLineNum(),
                    "link '" + out.name + "' has no shape that gives it a mass", "it gets 10 g");
  GiveMass(kLight_kg, out);
}

void InertiaReader::ReadInertial(const sdf::Link& link, bool is_solid, LinkModel& out) const {
  const std::string what = "link '" + out.name + "'";
  const int line = LineOf(link.Element());
  const bool foreign = reading_.source.foreign;
  const bool welded = welded_.contains(out.name);
  if (!link.Element()->HasElement("inertial")) {
    if (welded) return;  // a frame, or a shape without mass
    if (foreign && still_.contains(out.name)) return GiveMass(1, out);
    reading_.Complain(line, what + " needs <inertial> with <mass> and <inertia>", "it gets 10 g");
    if (foreign) GiveMass(kLight_kg, out);
    return;
  }
  const int inertial_line = LineOf(link.Element()->GetElement("inertial"));
  const ignition::math::Inertiald& inertial = link.Inertial();
  const auto& matrix = inertial.MassMatrix();
  out.mass_kg = matrix.Mass();
  if (foreign && out.mass_kg >= 0 && out.mass_kg < kLeast_kg) {
    out.mass_kg = 0;
    if (welded) return;
    if (still_.contains(out.name)) return GiveMass(1, out);
    reading_.Mended(inertial_line, what + " has no mass: it gets 10 g; write <mass> above 0");
    return GiveMass(kLight_kg, out);
  }
  if (!std::isfinite(out.mass_kg) || out.mass_kg < (foreign || out.is_carrier ? kLeast_kg : 1e-6) ||
      out.mass_kg > 1e6) {
    reading_.Error(foreign ? inertial_line : line,
                   "the mass of " + what + " must be a positive number of kg, at most 1e6");
    return;
  }
  Pose X_LI = reading_.CheckedPose(inertial.Pose(), link.Element(), "the inertia of " + what);
  const auto take_solid = [&](const std::string& wrong) {
    if (!welded && !still_.contains(out.name))
      reading_.Complain(inertial_line, wrong, "that of its first shape is taken, as a solid of this mass");
    GiveMass(out.mass_kg, out);
    out.X_LI = X_LI;
  };
  if (is_solid) {
    GiveMass(out.mass_kg, out);
    out.X_LI = X_LI;
    return;
  }
  // SDF's default is 1 kg m², regardless of the mass.
  if (!link.Element()->GetElement("inertial")->HasElement("inertia"))
    return take_solid(what + " needs <inertia>");
  const Vector3 principal = ToVector(matrix.PrincipalMoments());
  const double largest = principal.maxCoeff();
  if (!principal.allFinite() || !(principal.minCoeff() > (foreign || out.is_carrier ? 0 : 1e-12)) ||
      largest > 1e9 || principal.sum() - largest < largest * (1 - 1e-3)) {
    const std::string wrong =
        "the inertia of " + what +
        " is not that of a body: moments must be positive, and none above the sum of the other two";
    // Products that are too large are a typo; with a negative moment the numbers are unusable.
    const double least = ToVector(matrix.DiagonalMoments()).minCoeff();
    const bool negative = !principal.allFinite() || least < -1e-9 || largest > 1e9;
    if (foreign && !negative) return take_solid(wrong);
    reading_.Error(foreign ? inertial_line : line, wrong);
    return;
  }
  const auto axes = matrix.PrincipalAxesOffset();
  X_LI.q = (X_LI.q * Quaternion(axes.W(), axes.X(), axes.Y(), axes.Z())).normalized();
  out.X_LI = X_LI;
  out.inertia_kg_m2 = principal;
}

}  // namespace coopdyn
