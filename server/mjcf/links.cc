// SPDX-License-Identifier: MIT
// Writes links: mass, shapes and colours.
#include <algorithm>
#include <array>
#include <numbers>

#include "server/mjcf/parts.h"
#include "server/mjcf/sdf_text.h"

namespace coopdyn::mjcf {

namespace {

using tinyxml2::XMLElement;

constexpr double kEndless_m = 100;  // size of an infinite plane

/// False if SDF or coopdyn has no such shape.
bool AddShape(int geom, const Source& source, Meshes& meshes, XMLElement& parent) {
  const mjModel& m = source.model();
  const mjtNum* const size = m.geom_size + 3 * geom;
  XMLElement& geometry = Add(parent, "geometry");
  const auto round = [&](const char* name) {
    XMLElement& shape = Add(geometry, name);
    Add(shape, "radius", Number(size[0]));
    return &shape;
  };
  const auto mesh = [&](const Meshes::Named& named) {
    XMLElement& shape = Add(geometry, "mesh");
    Add(shape, "uri", named.uri);
    if (!named.scale.empty()) Add(shape, "scale", named.scale);
    return !named.uri.empty();
  };
  switch (m.geom_type[geom]) {
    case mjGEOM_PLANE: {
      XMLElement& plane = Add(geometry, "plane");
      Add(plane, "normal", "0 0 1");
      const auto side = [&](int i) { return Number(size[i] > 0 ? 2 * size[i] : kEndless_m); };
      Add(plane, "size", side(0) + " " + side(1));
      return true;
    }
    case mjGEOM_SPHERE:
      round("sphere");
      return true;
    case mjGEOM_CAPSULE:
    case mjGEOM_CYLINDER:
      Add(*round(m.geom_type[geom] == mjGEOM_CAPSULE ? "capsule" : "cylinder"), "length",
          Number(2 * size[1]));
      return true;
    case mjGEOM_ELLIPSOID:
      Add(Add(geometry, "ellipsoid"), "radii", Numbers(ToVector(size)));
      return true;
    case mjGEOM_BOX:
      Add(Add(geometry, "box"), "size", Numbers(2 * ToVector(size)));
      return true;
    case mjGEOM_MESH:
      return mesh(meshes.Mesh(m.geom_dataid[geom]));
    case mjGEOM_HFIELD:
      return mesh(meshes.Heights(m.geom_dataid[geom]));
    default:
      return false;
  }
}

/// True if no contact has friction. A contact uses the greater condim of its geoms, so condim 1
/// (frictionless) counts only if all colliding geoms have it.
bool IsFrictionless(const Source& source) {
  const mjModel& m = source.model();
  bool has_ground = false;
  for (int geom = 0; geom < m.ngeom; ++geom) {
    if (!source.Collides(geom)) continue;
    if (m.geom_condim[geom] > 1) return false;
    has_ground = has_ground || m.geom_bodyid[geom] == 0;
  }
  return has_ground;
}

void AddFriction(int geom, const Source& source, XMLElement& collision) {
  const mjModel& m = source.model();
  const mjtNum* const friction = m.geom_friction + 3 * geom;
  const int dimensions = m.geom_condim[geom];
  XMLElement& element = Add(Add(collision, "surface"), "friction");
  Add(Add(element, "ode"), "mu", Number(IsFrictionless(source) ? 0 : friction[0]));
  if (dimensions >= 4) {
    // The torque's lever arm is friction[1] in MuJoCo, and 3π/16 of the patch radius in SDF.
    XMLElement& torsional = Add(element, "torsional");
    Add(torsional, "coefficient", "1");
    Add(torsional, "patch_radius", Number(friction[1] * 16 / (3 * std::numbers::pi)));
  }
  const int type = m.geom_type[geom];
  const bool is_round = type == mjGEOM_SPHERE || type == mjGEOM_CAPSULE || type == mjGEOM_CYLINDER;
  if (dimensions >= 6 && is_round) Add(Add(element, "bullet"), "rolling_friction", Number(friction[2]));
}

std::array<float, 4> ColorOf(int geom, const mjModel& m) {
  const int material = m.geom_matid[geom];
  const float* const rgba = material >= 0 ? m.mat_rgba + 4 * material : m.geom_rgba + 4 * geom;
  return {rgba[0], rgba[1], rgba[2], rgba[3]};
}

}  // namespace

void AddGeom(int geom, const Pose& X_LB, const Source& source, Meshes& meshes, XMLElement& link) {
  const mjModel& m = source.model();
  constexpr int kFirstHiddenGroup = 3;  // MuJoCo's viewers show groups 0 to 2
  const std::string name = source.NameOf(mjOBJ_GEOM, geom, "geom");
  const Pose X_LG = X_LB * ToPose(m.geom_pos + 3 * geom, m.geom_quat + 4 * geom);
  if (source.Collides(geom)) {
    XMLElement& collision = AddNamed(link, "collision", name);
    AddPose(collision, X_LG);
    if (AddShape(geom, source, meshes, collision))
      AddFriction(geom, source, collision);
    else
      link.DeleteChild(&collision);
  }
  const std::array<float, 4> color = ColorOf(geom, m);
  const bool is_seen = m.geom_group[geom] < kFirstHiddenGroup && color[3] > 0;
  if (!is_seen) return;
  XMLElement& visual = AddNamed(link, "visual", name + "_visual");
  AddPose(visual, X_LG);
  if (!AddShape(geom, source, meshes, visual)) {
    link.DeleteChild(&visual);
    return;
  }
  std::string text;
  for (const float part : color) text += (text.empty() ? "" : " ") + Number(std::clamp(part, 0.0F, 1.0F));
  Add(Add(visual, "material"), "diffuse", text);
}

void AddLink(int body, const Pose& X_MB, const Source& source, Meshes& meshes, XMLElement& model) {
  const mjModel& m = source.model();
  XMLElement& link = AddNamed(model, "link", source.BodyName(body));
  AddPose(link, X_MB);
  if (m.body_mass[body] > 0) {
    XMLElement& inertial = Add(link, "inertial");
    AddPose(inertial, ToPose(m.body_ipos + 3 * body, m.body_iquat + 4 * body));
    // Raise masses below coopdyn's minimum; the difference is negligible.
    constexpr double kLeast_kg = 1e-6, kLeast_kg_m2 = 1e-10;
    if (m.body_mass[body] < kLeast_kg) source.words().Say("a body of less than 1 mg gets 1 mg");
    Add(inertial, "mass", Number(std::max(kLeast_kg, m.body_mass[body])));
    XMLElement& inertia = Add(inertial, "inertia");
    const mjtNum* const moments = m.body_inertia + 3 * body;
    for (const auto& [key, value] : {std::pair("ixx", moments[0]),
                                     {"iyy", moments[1]},
                                     {"izz", moments[2]},
                                     {"ixy", 0.0},
                                     {"ixz", 0.0},
                                     {"iyz", 0.0}})
      Add(inertia, key,
          Number(m.body_mass[body] < kLeast_kg && key[1] == key[2] ? std::max(kLeast_kg_m2, value) : value));
  }
  for (int i = 0; i < m.body_geomnum[body]; ++i)
    AddGeom(m.body_geomadr[body] + i, Pose(), source, meshes, link);
}

}  // namespace coopdyn::mjcf
