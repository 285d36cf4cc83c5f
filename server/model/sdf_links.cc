// SPDX-License-Identifier: MIT
// Reads the links of a robot with mass and shapes.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <sdf/sdf.hh>
#include <utility>

#include "server/model/sdf_body.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr double kMaxSize_m = 1e3;
constexpr double kMinLength_m = 1e-4;

Pose ToPose(const ignition::math::Pose3d& pose) {
  const auto& q = pose.Rot();
  return {ToVector(pose.Pos()), Quaternion(q.W(), q.X(), q.Y(), q.Z()).normalized()};
}

/// A shape and its pose in the frame of its <pose>.
struct PlacedShape {
  Shape shape;
  Pose X_PG;
  std::optional<Color> color;  // from a mesh file
};

/// The shortest rotation that takes the z axis to a unit vector. Eigen's own FromTwoVectors() takes 15 s to
/// compile.
Quaternion TurnFromZ(const Vector3& to) {
  const Quaternion twice(1 + to.z(), -to.y(), to.x(), 0);
  return twice.squaredNorm() > 1e-18 ? twice.normalized() : Quaternion(0, 1, 0, 0);
}

class LinkReader {
 public:
  explicit LinkReader(ModelReading& reading) : reading_(reading) {}

  void Read(const std::vector<ModelScope>& scopes) {
    for (const ModelScope& scope : scopes) {
      for (std::size_t i = 0; i < scope.model.LinkCount(); ++i)
        names_.push_back(scope.prefix + scope.model.LinkByIndex(i)->Name());
    }
    const InertiaReader inertias(scopes, reading_);
    for (const ModelScope& scope : scopes) ReadScope(scope, inertias);
    if (reading_.robot.links.empty())
      reading_.Error(scopes.front().xml.GetLineNum(), "the model has no <link>: the first is the chassis");
  }

 private:
  void ReadScope(const ModelScope& scope, const InertiaReader& inertias) {
    const tinyxml2::XMLElement* xml_link = scope.xml.FirstChildElement("link");
    for (std::size_t i = 0; i < scope.model.LinkCount(); ++i) {
      const sdf::Link& link = *scope.model.LinkByIndex(i);
      LinkModel out;
      out.name = scope.prefix + link.Name();
      const int line = LineOf(link.Element());
      reading_.lines.links.push_back(line);
      out.X_RL = scope.X_RM * reading_.Resolve(link.SemanticPose(), "__model__", link.Element(),
                                               "link '" + out.name + "'");
      if (std::ranges::count(reading_.robot.links, out.name, &LinkModel::name) > 0)
        reading_.Error(line, "there are two links '" + out.name + "': give one another name");
      prefix_ = scope.prefix;
      const std::vector<std::string> names = ReadCollisions(link, out);
      ReadVisuals(link, xml_link, out);
      out.is_carrier = xml_link != nullptr && xml_link->Attribute("coopdyn:carrier") != nullptr;
      inertias.Read(link, xml_link, out);
      reading_.robot.links.push_back(std::move(out));
      reading_.assembly.links.push_back({reading_.robot.links.back().name, names});
      if (xml_link != nullptr) xml_link = xml_link->NextSiblingElement("link");
    }
  }

  /// Reads the collisions and returns their names.
  std::vector<std::string> ReadCollisions(const sdf::Link& link, LinkModel& out) {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < link.CollisionCount(); ++c) {
      const sdf::Collision& collision = *link.CollisionByIndex(c);
      const std::string what = "collision '" + collision.Name() + "'";
      const auto placed = ToShape(*collision.Geom(), LineOf(collision.Element()), what);
      const Pose X_LG = reading_.Resolve(collision.SemanticPose(), link.Name(), collision.Element(), what);
      LinkShape shape;
      if (placed) shape = {placed->shape, X_LG * placed->X_PG, Color(), 1, false};
      if (const sdf::Mesh* mesh = collision.Geom()->MeshShape(); mesh != nullptr)
        shape.most_parts = MostParts(*mesh->Element());
      ReadFriction(collision, placed ? placed->X_PG.q : Quaternion::Identity(), shape);
      ReadYielding(collision, shape);
      shape.restitution = RestitutionOf(collision);
      if (placed) {
        out.collisions.push_back(std::move(shape));
        names.push_back(collision.Name());
      }
    }
    return names;
  }

  int MostParts(const sdf::Element& mesh) {
    const sdf::ParamPtr given = mesh.GetAttribute(kPartsAttribute);
    if (given == nullptr) return kMostConvexParts;
    const auto count = ParsePlain(given->GetAsString());
    return count ? static_cast<int>(std::clamp(*count, 1.0, double{kMostWantedParts})) : kMostConvexParts;
  }

  void ReadVisuals(const sdf::Link& link, const tinyxml2::XMLElement* xml_link, LinkModel& out) {
    const tinyxml2::XMLElement* xml_visual =
        xml_link == nullptr ? nullptr : xml_link->FirstChildElement("visual");
    for (std::size_t v = 0; v < link.VisualCount(); ++v) {
      const sdf::Visual& visual = *link.VisualByIndex(v);
      const std::string what = "visual '" + visual.Name() + "'";
      const auto placed = ToShape(*visual.Geom(), LineOf(visual.Element()), what, true);
      const Pose X_LG = reading_.Resolve(visual.SemanticPose(), link.Name(), visual.Element(), what);
      Color color = placed && placed->color ? *placed->color : Color();
      // Require <diffuse>: SDF's default is black, even for a material without a colour such as a Gazebo
      // script.
      if (visual.Material() != nullptr && visual.Material()->Element()->HasElement("diffuse")) {
        const auto& diffuse = visual.Material()->Diffuse();
        const auto clamp = [](double x) { return std::isfinite(x) ? std::clamp(x, 0.0, 1.0) : 0.0; };
        color = {clamp(diffuse.R()), clamp(diffuse.G()), clamp(diffuse.B())};
      }
      const bool robot_color =
          xml_visual != nullptr && TakesRobotColor(*xml_visual, reading_.file, reading_.diagnostics);
      if (placed) out.visuals.push_back({placed->shape, X_LG * placed->X_PG, color, 1, robot_color});
      if (xml_visual != nullptr) xml_visual = xml_visual->NextSiblingElement("visual");
    }
  }

  std::optional<PlacedShape> ToShape(const sdf::Geometry& geometry, int line, const std::string& what,
                                     bool is_visual = false) {
    // Models made for other programs have points, and floors of many kilometres, as collisions.
    bool fine = true, fits = !is_visual && reading_.source.foreign;
    const auto fit = [&](double size) {
      const bool good = size >= kMinLength_m && size <= kMaxSize_m;
      fine = fine && good;
      fits = fits && size >= 0;
      return good ? size : std::clamp(size, kMinLength_m, kMaxSize_m);
    };
    PlacedShape placed;
    if (const sdf::Box* box = geometry.BoxShape()) {
      const Vector3 size = ToVector(box->Size());
      placed.shape = Box{{fit(size.x()), fit(size.y()), fit(size.z())}};
    } else if (const sdf::Cylinder* cylinder = geometry.CylinderShape()) {
      placed.shape = Cylinder{fit(cylinder->Radius()), fit(cylinder->Length())};
    } else if (const sdf::Sphere* sphere = geometry.SphereShape()) {
      placed.shape = Sphere{fit(sphere->Radius())};
    } else if (const sdf::Capsule* capsule = geometry.CapsuleShape()) {
      placed.shape = Capsule{fit(capsule->Radius()), fit(capsule->Length())};
    } else if (const sdf::Plane* plane = geometry.PlaneShape()) {
      constexpr double kDepth_m = 0.1;
      const Vector3 normal = ToVector(plane->Normal());
      placed.shape = Box{{fit(plane->Size().X()), fit(plane->Size().Y()), kDepth_m}};
      if (!normal.allFinite() || normal.norm() <= 1e-9) fine = fits = false;
      if (fine) placed.X_PG.q = TurnFromZ(normal.normalized());
      placed.X_PG.p = placed.X_PG.q * Vector3(0, 0, -kDepth_m / 2);
    } else if (const sdf::Mesh* mesh = geometry.MeshShape()) {
      const auto known = reading_.source.meshes.find(mesh->Uri());
      if (known == reading_.source.meshes.end()) {
        reading_.Error(line, what + " names a mesh that is not there: '" + mesh->Uri() + "'");
        return std::nullopt;
      }
      const MeshData& data = *known->second.data;
      placed.shape = Mesh{&data};
      placed.X_PG.p = known->second.middle;
      if (data.color) placed.color = Color{(*data.color)[0], (*data.color)[1], (*data.color)[2]};
      fine = data.radius_m >= kMinLength_m && data.radius_m <= kMaxSize_m;
      fits = false;
    } else {
      reading_.Error(
          line, what + " needs a <geometry> with <box>, <cylinder>, <sphere>, <capsule>, <plane> or <mesh>");
      return std::nullopt;
    }
    if (!fine) {
      const std::string wrong = "the sizes of " + what + " must lie between 0.1 mm and 1 km";
      if (fits) {
        reading_.diagnostics.Mended({reading_.file, line},
                                    wrong + ": it collides with the nearest size that may be");
        return placed;
      }
      if (is_visual) {
        reading_.Complain(line, wrong, "it is not drawn");
      } else {
        reading_.Error(line, wrong);
      }
      return std::nullopt;
    }
    return placed;
  }

  /// Reads the friction of a collision. `q_CG`: orientation of its shape in its frame.
  void ReadFriction(const sdf::Collision& collision, const Quaternion& q_CG, LinkShape& out) {
    sdf::ElementPtr friction = collision.Element();
    for (const char* name : {"surface", "friction"}) {
      if (!friction->HasElement(name)) return;
      friction = friction->GetElement(name);
    }
    if (friction->HasElement("ode")) ReadSliding(friction->GetElement("ode"), q_CG, out);
    if (friction->HasElement("torsional")) ReadTorsional(friction->GetElement("torsional"), out);
    if (!friction->HasElement("bullet")) return;
    const sdf::ElementPtr bullet = friction->GetElement("bullet");
    if (!bullet->HasElement("rolling_friction")) return;
    out.rolling_friction_m = NotNegative(bullet, "rolling_friction");
    const bool has_faces = std::holds_alternative<Box>(out.shape) || std::holds_alternative<Mesh>(out.shape);
    if (has_faces && out.rolling_friction_m > 0)
      reading_.Warn(LineOf(bullet->GetElement("rolling_friction")),
                    "<rolling_friction> slows spheres, cylinders and capsules only: remove it here, or write "
                    "<torsional>, which slows spinning of all shapes");
  }

  /// Reads the spring and the damper of a collision.
  void ReadYielding(const sdf::Collision& collision, LinkShape& out) {
    sdf::ElementPtr contact = collision.Element();
    for (const char* name : {"surface", "contact", "ode"}) {
      if (!contact->HasElement(name)) return;
      contact = contact->GetElement(name);
    }
    const auto value = [&](const char* name) { return contact->Get<double>(name); };
    const auto mended = [&](const char* name, const std::string& what) {
      reading_.Mended(LineOf(contact->GetElement(name)), what);
    };
    if (!contact->HasElement("kp")) {
      if (contact->HasElement("kd"))
        mended("kd", "<kd> needs <kp>, the stiffness in N/m: without it the contact is hard");
      return;
    }
    if (!(value("kp") > 0)) {
      return mended("kp", "<kp> must be a number above 0, N/m, not '" + FormatNumber(value("kp")) +
                              "': the contact is hard");
    }
    const double damping = contact->HasElement("kd") ? value("kd") : 0;
    const bool is_damping = std::isfinite(damping) && damping >= 0;
    if (!is_damping)
      mended("kd", "<kd> must be a number from 0 on, N s/m, not '" + FormatNumber(damping) + "': it is 0");
    out.contact_stiffness_n_m = value("kp");
    out.contact_damping_n_s_m = is_damping ? damping : 0;
  }

  void ReadSliding(const sdf::ElementPtr& element, const Quaternion& q_CG, LinkShape& out) {
    if (element->HasElement("mu")) out.friction = NotNegative(element, "mu");
    const double across = element->HasElement("mu2") ? NotNegative(element, "mu2") : out.friction;
    if (across == out.friction) return;
    const Vector3 along = element->HasElement("fdir1")
                              ? ToVector(element->Get<ignition::math::Vector3d>("fdir1"))
                              : Vector3::Zero();
    constexpr double kShortest = 1e-6;
    if (!along.allFinite() || along.norm() < kShortest) {
      reading_.Mended(LineOf(element),
                      "<mu2> needs <fdir1>, the direction in which <mu> counts, for example 1 0 0: " +
                          ("friction is " + FormatNumber(out.friction)) + " in all directions");
      return;
    }
    out.friction_across = across;
    out.friction_frame = FrameOf(element->GetElement("fdir1"));
    out.friction_along_G =
        out.friction_frame < 0 ? Vector3(q_CG.conjugate() * along.normalized()) : along.normalized();
  }

  /// Index among the file's links of the link to which an <fdir1> is fixed; -1: its own link.
  int FrameOf(const sdf::ElementPtr& fdir1) {
    for (const char* key : {"gz:expressed_in", "ignition:expressed_in"}) {
      if (!fdir1->HasAttribute(key)) continue;
      const std::string name = fdir1->GetAttribute(key)->GetAsString();
      const auto found = std::ranges::find(names_, prefix_ + name);
      if (found != names_.end()) return static_cast<int>(found - names_.begin());
      reading_.Warn(LineOf(fdir1), std::string(key) + " of <fdir1> names no link, '" + name +
                                       "': the direction turns with the collision");
    }
    return -1;
  }

  /// Reads torsional friction. The lever arm of a Hertzian contact patch is 3π/16 of its radius (K. L.
  /// Johnson (1985), Contact Mechanics).
  void ReadTorsional(const sdf::ElementPtr& element, LinkShape& out) {
    const double coefficient = element->HasElement("coefficient") ? NotNegative(element, "coefficient") : 1;
    const double radius_m = element->HasElement("patch_radius") ? NotNegative(element, "patch_radius") : 0;
    if (element->HasElement("use_patch_radius") && !element->Get<bool>("use_patch_radius")) {
      reading_.Warn(LineOf(element),
                    "<torsional> counts by its <patch_radius> only: write it, in m, and "
                    "<use_patch_radius>true</use_patch_radius>");
      return;
    }
    if (element->HasElement("coefficient") && coefficient > 0 && !element->HasElement("patch_radius"))
      reading_.Warn(
          LineOf(element),
          "<torsional> has no effect without the radius of the contact's patch, in m: write it, for "
          "example <patch_radius>0.01</patch_radius>");
    out.spinning_friction_m = 3 * std::numbers::pi / 16 * coefficient * radius_m;
  }

  double NotNegative(const sdf::ElementPtr& element, const char* name) {
    const double value = element->Get<double>(name);
    constexpr double kMost = 1e3;  // effectively no slip; many models have larger numbers
    if (std::isfinite(value) && value >= 0) return std::min(value, kMost);
    reading_.Error(
        LineOf(element->GetElement(name)),
        "<" + std::string(name) + "> cannot be '" + FormatNumber(value) + "': write a number from 0 on");
    return 0;
  }

  double RestitutionOf(const sdf::Collision& collision) {
    sdf::ElementPtr element = collision.Element();
    for (const char* name : {"surface", "bounce"}) {
      if (!element->HasElement(name)) return 0;
      element = element->GetElement(name);
    }
    if (!element->HasElement("restitution_coefficient")) return 0;
    const double restitution = element->Get<double>("restitution_coefficient");
    if (!(restitution >= 0 && restitution <= 1)) {
      reading_.Error(LineOf(element), "<restitution_coefficient> must be a number from 0 to 1");
      return 0;
    }
    return restitution;
  }

  ModelReading& reading_;
  std::vector<std::string> names_;  // of all links of the file, in order
  std::string prefix_;              // of names in the current model
};

}  // namespace

int LineOf(const sdf::ElementPtr& element) {
  return element ? element->LineNumber().value_or(0) : 0;
}

Vector3 ToVector(const ignition::math::Vector3d& v) {
  return {v.X(), v.Y(), v.Z()};
}

Pose ModelReading::CheckedPose(const ignition::math::Pose3d& pose, const sdf::ElementPtr& element,
                               const std::string& what) {
  const Pose out = ToPose(pose);
  if (!out.p.allFinite() || !out.q.coeffs().allFinite() || out.p.cwiseAbs().maxCoeff() > kMaxSize_m) {
    Error(LineOf(element), "the pose of " + what + " is not finite or more than 1 km away");
    return {};
  }
  return out;
}

Pose ModelReading::Resolve(const sdf::SemanticPose& pose, const std::string& relative_to,
                           const sdf::ElementPtr& element, const std::string& what) {
  ignition::math::Pose3d out;
  const sdf::Errors errors = pose.Resolve(out, relative_to);
  if (!errors.empty()) {
    Complain(LineOf(element), errors.front().Message(), "the pose counts from its own link");
    out = pose.RawPose();
  }
  return CheckedPose(out, element, what);
}

std::vector<ModelScope> ScopesOf(const sdf::Model& model, const tinyxml2::XMLElement& xml,
                                 ModelReading& reading) {
  std::vector<ModelScope> scopes{{model, xml, "", {}}};
  for (std::size_t i = 0; i < scopes.size(); ++i) {
    const tinyxml2::XMLElement* inner_xml = scopes[i].xml.FirstChildElement("model");
    for (std::size_t k = 0; k < scopes[i].model.ModelCount() && inner_xml != nullptr; ++k) {
      const sdf::Model& inner = *scopes[i].model.ModelByIndex(k);
      const std::string name = scopes[i].prefix + inner.Name();
      const Pose X_MI =
          reading.Resolve(inner.SemanticPose(), "__model__", inner.Element(), "model '" + name + "'");
      scopes.push_back({inner, *inner_xml, name + "::", scopes[i].X_RM * X_MI});
      inner_xml = inner_xml->NextSiblingElement("model");
    }
  }
  return scopes;
}

void ReadLinks(const std::vector<ModelScope>& scopes, ModelReading& reading) {
  LinkReader(reading).Read(scopes);
}

}  // namespace coopdyn
