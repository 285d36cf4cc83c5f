// SPDX-License-Identifier: MIT
// Replaces <ellipsoid> and <cone> by meshes with corners on their surface and the inertia of the solid.
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "server/base/portable_math.h"
#include "server/model/model_source.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr std::uint32_t kAround = 24, kUp = 12;  // corners; a hull keeps about 300

/// The finite numbers in the text of `node`; nullopt unless there are `count`.
std::optional<std::vector<double>> SomeNumbers(const XmlNode* node, std::size_t count) {
  std::vector<double> numbers;
  for (const std::string& word : SplitWords(node == nullptr ? "" : node->text)) {
    const auto value = ParsePlain(word);
    if (!value) return std::nullopt;
    numbers.push_back(*value);
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

/// A solid centred at the middle of its bounding box.
struct RoundSolid {
  bool is_cone = false;
  Vector3 half_m;  // half extents of the box

  /// The centre of mass.
  Vector3 centre() const { return {0, 0, is_cone ? -half_m.z() / 2 : 0}; }
  double volume_m3() const {
    return (is_cone ? 2.0 / 3 : 4.0 / 3) * std::numbers::pi *
           half_m.prod();  // its length is twice half_m.z()
  }
  /// About the centre of mass, for 1 kg.
  Vector3 inertia_m2() const {
    const Vector3 s2 = half_m.cwiseAbs2();
    if (!is_cone) return Vector3(s2.y() + s2.z(), s2.x() + s2.z(), s2.x() + s2.y()) / 5;
    const double across = 3.0 / 20 * (s2.x() + s2.z());
    return {across, across, 3.0 / 10 * s2.x()};
  }

  MeshParts Corners() const {
    MeshParts parts;
    const auto ring = [&](double radius, double z) {
      for (std::uint32_t i = 0; i < kAround; ++i) {
        const double angle = 2 * std::numbers::pi * i / kAround;
        parts.vertices.push_back(
            Vector3(radius * portable::Cos(angle), radius * portable::Sin(angle), z).cwiseProduct(half_m));
      }
    };
    std::uint32_t rings = 0;
    if (is_cone) {
      ring(1, -1);
      rings = 1;
    } else {
      for (rings = 0; rings + 1 < kUp; ++rings) {
        const double angle = std::numbers::pi * (rings + 1) / kUp;
        ring(portable::Sin(angle), -portable::Cos(angle));
      }
    }
    const std::uint32_t bottom = rings * kAround, top = bottom + 1;
    parts.vertices.emplace_back(0, 0, -half_m.z());
    parts.vertices.emplace_back(0, 0, half_m.z());
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const std::uint32_t next = (i + 1) % kAround;
      parts.triangles.push_back({bottom, next, i});
      for (std::uint32_t k = 0; k + 1 < rings; ++k) {
        const std::uint32_t low = k * kAround, high = low + kAround;
        parts.triangles.push_back({low + i, low + next, high + next});
        parts.triangles.push_back({low + i, high + next, high + i});
      }
      const std::uint32_t last = (rings - 1) * kAround;
      parts.triangles.push_back({last + i, last + next, top});
    }
    return parts;
  }
};

class RoundWriter {
 public:
  RoundWriter(MeshTable& table, Diagnostics& diagnostics) : table_(table), diagnostics_(diagnostics) {}

  void Write(XmlNode& node) {
    if (node.name == "link") GiveInertia(node);
    if (node.name == "collision" && node.Has(kDensityAttribute)) KeepSolid(node);
    if (node.name == "geometry") {
      for (XmlNode& shape : node.children) WriteShape(shape);
      return;
    }
    for (XmlNode& child : node.children) Write(child);
  }

 private:
  /// The solid of an <ellipsoid> or <cone>; nullopt for other shapes and wrong sizes.
  static std::optional<RoundSolid> SolidOf(const XmlNode& shape) {
    RoundSolid solid;
    if (shape.name == "ellipsoid") {
      const auto radii = SomeNumbers(shape.Child("radii"), 3);
      if (!radii) return std::nullopt;
      solid.half_m = {(*radii)[0], (*radii)[1], (*radii)[2]};
    } else if (shape.name == "cone") {
      const auto radius = SomeNumbers(shape.Child("radius"), 1),
                 length = SomeNumbers(shape.Child("length"), 1);
      if (!radius || !length) return std::nullopt;
      solid.is_cone = true;
      solid.half_m = {radius->front(), radius->front(), length->front() / 2};
    } else {
      return std::nullopt;
    }
    constexpr double kLeast_m = 1e-4, kMost_m = 1e3;
    if (!(solid.half_m.minCoeff() >= kLeast_m && solid.half_m.maxCoeff() <= kMost_m)) return std::nullopt;
    return solid;
  }

  void WriteShape(XmlNode& shape) {
    if (shape.name != "ellipsoid" && shape.name != "cone") return;
    const auto solid = SolidOf(shape);
    if (!solid) {
      diagnostics_.Error(shape.where, shape.name == "cone"
                                          ? "<cone> needs <radius> and <length>, from 0.1 mm to 1 km"
                                          : "<ellipsoid> needs <radii>, three numbers from 0.1 mm to 1 km");
      return;
    }
    const std::string key = "mesh:" + std::to_string(table_.size() + 1);
    table_.emplace(key, MakeModelMesh(solid->Corners()));
    shape.name = "mesh";
    shape.children.clear();
    shape.Add("uri", key);
  }

  static void KeepSolid(XmlNode& collision) {
    const XmlNode* geometry = collision.Child("geometry");
    const auto solid = geometry == nullptr || geometry->children.empty()
                           ? std::nullopt
                           : SolidOf(geometry->children.front());
    if (!solid) return;
    const Vector3 moments = solid->inertia_m2();
    std::string text;
    for (const double value :
         {solid->volume_m3(), moments.x(), moments.y(), moments.z(), solid->centre().z()})
      text += FormatNumber(value) + " ";
    collision.Set(kSolidAttribute, text);
  }

  static void GiveInertia(XmlNode& link) {
    const XmlNode* holder =
        link.Child("collision") != nullptr ? link.Child("collision") : link.Child("visual");
    const XmlNode* geometry = holder == nullptr ? nullptr : holder->Child("geometry");
    if (geometry == nullptr || geometry->children.empty()) return;
    const auto solid = SolidOf(geometry->children.front());
    XmlNode* inertial = link.Child("inertial");
    if (!solid || inertial == nullptr || inertial->Child("inertia") != nullptr) return;
    const auto mass_kg = SomeNumbers(inertial->Child("mass"), 1);
    if (!mass_kg || !(mass_kg->front() > 0)) return;
    if (inertial->Child("pose") == nullptr) PlaceAt(*holder, *solid, *inertial);
    const Vector3 moments = solid->inertia_m2() * mass_kg->front();
    XmlNode& inertia = inertial->Add("inertia");
    inertia.Add("ixx", FormatNumber(moments.x()));
    inertia.Add("iyy", FormatNumber(moments.y()));
    inertia.Add("izz", FormatNumber(moments.z()));
  }

  /// Moves the centre of mass to that of the shape in `holder`.
  static void PlaceAt(const XmlNode& holder, const RoundSolid& solid, XmlNode& inertial) {
    const XmlNode* pose = holder.Child("pose");
    std::vector<double> v(6);
    if (pose != nullptr) {
      const auto given = SomeNumbers(pose, 6);
      if (!given || !pose->attributes.empty()) return;
      v = *given;
    }
    const Vector3 p = Vector3(v[0], v[1], v[2]) + FromRollPitchYaw(v[3], v[4], v[5]) * solid.centre();
    std::string text;
    for (const double value : {p.x(), p.y(), p.z(), v[3], v[4], v[5]}) text += FormatNumber(value) + " ";
    inertial.Add("pose", text);
  }

  MeshTable& table_;
  Diagnostics& diagnostics_;
};

}  // namespace

void MakeRoundMeshes(XmlNode& model, MeshTable& table, Diagnostics& diagnostics) {
  RoundWriter(table, diagnostics).Write(model);
}

}  // namespace coopdyn
