// SPDX-License-Identifier: MIT
// Links, joints and shapes of a robot through libsdformat; our own elements through sdf_extension.h.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <ignition/math/Inertial.hh>
#include <numbers>
#include <optional>
#include <sdf/sdf.hh>
#include <set>
#include <utility>
#include <vector>

#include "server/model/readers.h"
#include "server/model/sdf_parts.h"
#include "server/model/text_file.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr double kMaxSize_m = 1e3;
constexpr double kMinLength_m = 1e-4;

Vector3 ToVector(const ignition::math::Vector3d& v) {
  return {v.X(), v.Y(), v.Z()};
}
Pose ToPose(const ignition::math::Pose3d& pose) {
  const auto& q = pose.Rot();
  return {ToVector(pose.Pos()), Quaternion(q.W(), q.X(), q.Y(), q.Z()).normalized()};
}

int LineOf(const sdf::ElementPtr& element) {
  return element ? element->LineNumber().value_or(0) : 0;
}

class RobotReader {
 public:
  RobotReader(std::string file, std::string type, Diagnostics& diagnostics)
      : file_(std::move(file)), diagnostics_(diagnostics) {
    robot_->type = std::move(type);
    robot_->file = file_;
  }

  std::shared_ptr<const RobotModel> Read(std::string text) {
    robot_->text = std::move(text);
    const tinyxml2::XMLElement* root = Parse();
    if (root == nullptr) return nullptr;
    sdf::Root loaded;
    const sdf::Model* model = Load(*root, loaded);
    if (model == nullptr) return nullptr;
    const tinyxml2::XMLElement& xml_model = *root->FirstChildElement("model");
    ReadLinks(*model, xml_model);
    ReadJoints(*model);
    if (!diagnostics_.has_errors()) WeldLinks(fixed_, lines_, file_, *robot_, diagnostics_);
    if (!diagnostics_.has_errors()) ReadExtension(xml_model, file_, *robot_, diagnostics_);
    if (!diagnostics_.has_errors()) CheckStops();
    if (diagnostics_.has_errors()) return nullptr;
    Measure();
    return diagnostics_.has_errors() ? nullptr : robot_;
  }

 private:
  void Error(int line, std::string text) { diagnostics_.Error({file_, line}, std::move(text)); }

  /// ODE's own stops end at ±180 degrees; only control boards count further.
  void CheckStops() {
    for (std::size_t i = 0; i < robot_->joints.size(); ++i) {
      const JointModel& joint = robot_->joints[i];
      const bool is_far = (std::isfinite(joint.lower) && joint.lower < -std::numbers::pi) ||
                          (std::isfinite(joint.upper) && joint.upper > std::numbers::pi);
      if (joint.kind != JointModel::Kind::kHinge || !is_far || robot_->IsDriven(static_cast<int>(i)))
        continue;
      Error(lines_.joints[i], "a stop of joint '" + joint.name +
                                  "' beyond 180 degrees needs a motor: write at most 3.1415, none, or "
                                  "<limit><effort> and <velocity>");
    }
  }

  /// The XML's root; null with an error if it is no SDF.
  const tinyxml2::XMLElement* Parse() {
    if (!IsModelSize(robot_->text, file_, diagnostics_)) return nullptr;
    if (document_.Parse(robot_->text.c_str(), robot_->text.size()) != tinyxml2::XML_SUCCESS) {
      Error(document_.ErrorLineNum(), std::string("not well-formed XML (") + document_.ErrorName() + ")");
      return nullptr;
    }
    const tinyxml2::XMLElement* root = document_.RootElement();
    if (root == nullptr || std::string_view(root->Name()) != "sdf") {
      Error(root == nullptr ? 0 : root->GetLineNum(), "a robot model starts with <sdf version=\"1.9\">");
      return nullptr;
    }
    if (!IsModelCount(*root, file_, diagnostics_)) return nullptr;
    const char* version = root->Attribute("version");
    const std::string_view text = version == nullptr ? "" : version;
    if (text != "1.7" && text != "1.8" && text != "1.9") {
      Error(root->GetLineNum(),
            "SDF version '" + std::string(text) + "' is not supported: write version=\"1.9\"");
      return nullptr;
    }
    const tinyxml2::XMLElement* model = root->FirstChildElement("model");
    if (model == nullptr || model->NextSiblingElement("model") != nullptr) {
      Error(root->GetLineNum(), "a robot's file holds exactly one <model>");
      return nullptr;
    }
    if (root->Attribute("xmlns:coopdyn") == nullptr) {
      Error(root->GetLineNum(),
            "write xmlns:coopdyn=\"https://coopdyn.dev/sdf\" in <sdf>: a robot needs elements "
            "of this namespace (docs/formats.md)");
    }
    return root;
  }

  const sdf::Model* Load(const tinyxml2::XMLElement& root, sdf::Root& loaded) {
    // libsdformat's console is the process's, and everything it says comes back as errors too.
    sdf::Console::Instance()->SetQuiet(true);
    const sdf::SDFPtr description(new sdf::SDF());
    sdf::init(description);
    CheckSdf(root, description->Root(), file_, diagnostics_);
    // A text with mistakes would be taken for URDF next, whose parser prints to the console.
    if (diagnostics_.has_errors()) return nullptr;
    sdf::Errors errors;
    const sdf::ParserConfig config;
    if (sdf::readString(robot_->text, config, description, errors)) {
      const sdf::Errors more = loaded.Load(description, config);
      errors.insert(errors.end(), more.begin(), more.end());
    }
    for (const sdf::Error& error : errors) {
      constexpr std::size_t kMaxShown = 300;
      std::string text = error.Message().substr(0, kMaxShown);
      std::replace(text.begin(), text.end(), '\n', ' ');
      Error(error.LineNumber().value_or(0), std::move(text));
    }
    if (diagnostics_.has_errors()) return nullptr;
    if (loaded.Model() == nullptr) Error(root.GetLineNum(), "there is no <model>");
    return loaded.Model();
  }

  /// Checks that a pose is finite and near; reports otherwise.
  Pose CheckedPose(const ignition::math::Pose3d& pose, const sdf::ElementPtr& element,
                   const std::string& what) {
    const Pose out = ToPose(pose);
    if (!out.p.allFinite() || !out.q.coeffs().allFinite() || out.p.cwiseAbs().maxCoeff() > kMaxSize_m) {
      Error(LineOf(element), "the pose of " + what + " is not finite or more than 1 km away");
      return {};
    }
    return out;
  }

  Pose Resolve(const sdf::SemanticPose& pose, const std::string& relative_to, const sdf::ElementPtr& element,
               const std::string& what) {
    ignition::math::Pose3d out;
    for (const sdf::Error& error : pose.Resolve(out, relative_to)) Error(LineOf(element), error.Message());
    return CheckedPose(out, element, what);
  }

  std::optional<Shape> ToShape(const sdf::Geometry& geometry, int line, const std::string& what) {
    const auto good = [&](double size) {
      return std::isfinite(size) && size >= kMinLength_m && size <= kMaxSize_m;
    };
    Shape shape;
    bool fine = false;
    if (const sdf::Box* box = geometry.BoxShape()) {
      const Vector3 size = ToVector(box->Size());
      shape = Box{size};
      fine = good(size.x()) && good(size.y()) && good(size.z());
    } else if (const sdf::Cylinder* cylinder = geometry.CylinderShape()) {
      shape = Cylinder{cylinder->Radius(), cylinder->Length()};
      fine = good(cylinder->Radius()) && good(cylinder->Length());
    } else if (const sdf::Sphere* sphere = geometry.SphereShape()) {
      shape = Sphere{sphere->Radius()};
      fine = good(sphere->Radius());
    } else {
      Error(line, what + " needs a <geometry> with <box>, <cylinder> or <sphere>");
      return std::nullopt;
    }
    if (!fine) {
      Error(line, "the sizes of " + what + " must lie between 0.1 mm and 1 km");
      return std::nullopt;
    }
    return shape;
  }

  double FrictionOf(const sdf::Collision& collision) {
    sdf::ElementPtr element = collision.Element();
    for (const char* name : {"surface", "friction", "ode"}) {
      if (!element->HasElement(name)) return 1;
      element = element->GetElement(name);
    }
    const double mu = element->HasElement("mu") ? element->Get<double>("mu") : 1;
    const double mu2 = element->HasElement("mu2") ? element->Get<double>("mu2") : mu;
    if (!std::isfinite(mu) || mu < 0 || mu > 1e3) {
      Error(LineOf(element), "<mu> must be a number from 0 to 1000");
    } else if (mu2 != mu) {
      diagnostics_.Warning({file_, LineOf(element)},
                           "<mu2> is not used: friction is " + FormatNumber(mu) + " in all directions");
    }
    return mu;
  }

  /// A fixed joint holds it to another link.
  bool IsWelded(const sdf::Link& link) const { return welded_.contains(link.Name()); }

  void ReadInertial(const sdf::Link& link, LinkModel& out) {
    const std::string what = "link '" + out.name + "'";
    const int line = LineOf(link.Element());
    if (!link.Element()->HasElement("inertial")) {
      if (IsWelded(link)) return;  // a frame, or a shape without mass
      Error(line, what + " needs <inertial> with <mass> and <inertia>");
      return;
    }
    const ignition::math::Inertiald& inertial = link.Inertial();
    const auto& matrix = inertial.MassMatrix();
    const Vector3 principal = ToVector(matrix.PrincipalMoments());
    out.mass_kg = matrix.Mass();
    if (!std::isfinite(out.mass_kg) || out.mass_kg < 1e-6 || out.mass_kg > 1e6) {
      Error(line, "the mass of " + what + " must be a positive number of kg, at most 1e6");
      return;
    }
    const double largest = principal.maxCoeff();
    if (!principal.allFinite() || !(principal.minCoeff() > 1e-12) || largest > 1e9 ||
        principal.sum() - largest < largest * (1 - 1e-3)) {
      Error(line,
            "the inertia of " + what +
                " is not that of a body: moments must be positive, and no one above the sum of the others");
      return;
    }
    Pose X_LI = CheckedPose(inertial.Pose(), link.Element(), "the inertia of " + what);
    const auto axes = matrix.PrincipalAxesOffset();
    X_LI.q = (X_LI.q * Quaternion(axes.W(), axes.X(), axes.Y(), axes.Z())).normalized();
    out.X_LI = X_LI;
    out.inertia_kg_m2 = principal;
  }

  void ReadLinks(const sdf::Model& model, const tinyxml2::XMLElement& xml_model) {
    for (std::size_t i = 0; i < model.JointCount(); ++i) {
      const sdf::Joint& joint = *model.JointByIndex(i);
      std::string parent, child;
      if (joint.Type() != sdf::JointType::FIXED || !joint.ResolveParentLink(parent).empty() ||
          parent == "world")
        continue;
      if (joint.ResolveChildLink(child).empty()) welded_.insert(child);
    }
    const tinyxml2::XMLElement* xml_link = xml_model.FirstChildElement("link");
    for (std::size_t i = 0; i < model.LinkCount(); ++i) {
      const sdf::Link& link = *model.LinkByIndex(i);
      LinkModel out;
      out.name = link.Name();
      lines_.links.push_back(LineOf(link.Element()));
      out.X_RL = Resolve(link.SemanticPose(), "__model__", link.Element(), "link '" + out.name + "'");
      ReadInertial(link, out);
      for (std::size_t c = 0; c < link.CollisionCount(); ++c) {
        const sdf::Collision& collision = *link.CollisionByIndex(c);
        const std::string what = "collision '" + collision.Name() + "'";
        const auto shape = ToShape(*collision.Geom(), LineOf(collision.Element()), what);
        const Pose X_LG = Resolve(collision.SemanticPose(), link.Name(), collision.Element(), what);
        const double friction = FrictionOf(collision);
        if (shape) out.collisions.push_back({*shape, X_LG, Color(), friction, false});
      }
      const tinyxml2::XMLElement* xml_visual =
          xml_link == nullptr ? nullptr : xml_link->FirstChildElement("visual");
      for (std::size_t v = 0; v < link.VisualCount(); ++v) {
        const sdf::Visual& visual = *link.VisualByIndex(v);
        const std::string what = "visual '" + visual.Name() + "'";
        const auto shape = ToShape(*visual.Geom(), LineOf(visual.Element()), what);
        const Pose X_LG = Resolve(visual.SemanticPose(), link.Name(), visual.Element(), what);
        Color color;
        if (visual.Material() != nullptr) {
          const auto& diffuse = visual.Material()->Diffuse();
          const auto clamp = [](double x) { return std::isfinite(x) ? std::clamp(x, 0.0, 1.0) : 0.0; };
          color = {clamp(diffuse.R()), clamp(diffuse.G()), clamp(diffuse.B())};
        }
        const bool robot_color = xml_visual != nullptr && TakesRobotColor(*xml_visual, file_, diagnostics_);
        if (shape) out.visuals.push_back({*shape, X_LG, color, 1, robot_color});
        if (xml_visual != nullptr) xml_visual = xml_visual->NextSiblingElement("visual");
      }
      robot_->links.push_back(std::move(out));
      if (xml_link != nullptr) xml_link = xml_link->NextSiblingElement("link");
    }
    if (robot_->links.empty())
      Error(xml_model.GetLineNum(), "the model has no <link>: the first is the chassis");
  }

  int FindLink(const std::string& name) const {
    for (std::size_t i = 0; i < robot_->links.size(); ++i) {
      if (robot_->links[i].name == name) return static_cast<int>(i);
    }
    return -1;
  }

  /// Index of a link; FixedJoint::kWorld: the world; nothing if there is none.
  std::optional<int> FindEnd(const std::string& name) const {
    if (name == "world") return FixedJoint::kWorld;
    const int link = FindLink(name);
    return link < 0 ? std::nullopt : std::optional<int>(link);
  }

  void ReadJoints(const sdf::Model& model) {
    for (std::size_t i = 0; i < model.JointCount(); ++i) {
      const sdf::Joint& joint = *model.JointByIndex(i);
      const int line = LineOf(joint.Element());
      const std::string what = "joint '" + joint.Name() + "'";
      const bool slides = joint.Type() == sdf::JointType::PRISMATIC;
      const bool turns =
          joint.Type() == sdf::JointType::REVOLUTE || joint.Type() == sdf::JointType::CONTINUOUS;
      const bool fixed = joint.Type() == sdf::JointType::FIXED;
      if (!slides && !turns && !fixed) {
        Error(line, what + " must be of type revolute, continuous, prismatic or fixed");
        continue;
      }
      std::string parent, child;
      for (const sdf::Error& e : joint.ResolveParentLink(parent)) Error(line, e.Message());
      for (const sdf::Error& e : joint.ResolveChildLink(child)) Error(line, e.Message());
      const std::optional<int> from = FindEnd(parent), to = FindEnd(child);
      if (!from || !to || *to == FixedJoint::kWorld || *from == *to) {
        Error(line,
              what + " needs <parent> and <child> that are two links of this model; <parent> may be world");
        continue;
      }
      if (fixed) {
        fixed_.push_back({*from, *to, line});
        continue;
      }
      if (*from == FixedJoint::kWorld) {
        Error(line, what + " hangs on the world: make a link that is fixed to the world its <parent>");
        continue;
      }
      JointModel out;
      out.name = joint.Name();
      out.kind = slides ? JointModel::Kind::kSlider : JointModel::Kind::kHinge;
      out.parent = *from;
      out.child = *to;
      const sdf::JointAxis* axis = joint.Axis(0);
      if (axis == nullptr) {
        Error(line, what + " needs an <axis>");
        continue;
      }
      out.p_RJ = Resolve(joint.SemanticPose(), "__model__", joint.Element(), what).p;
      ignition::math::Vector3d xyz;
      for (const sdf::Error& e : axis->ResolveXyz(xyz, "__model__")) Error(line, e.Message());
      const Vector3 direction = ToVector(xyz);
      if (!direction.allFinite() || direction.norm() < 1e-9) {
        Error(line, "the axis of " + what + " has no direction");
        continue;
      }
      out.axis_R = direction.normalized();
      ReadAxis(*axis, joint.Type() == sdf::JointType::CONTINUOUS, line, out);
      robot_->joints.push_back(std::move(out));
      lines_.joints.push_back(line);
    }
  }

  void ReadAxis(const sdf::JointAxis& axis, bool endless, int line, JointModel& out) {
    const std::string what = "joint '" + out.name + "'";
    constexpr double kNone = 1e15;  // a limit from here on means none
    if (!endless && axis.Lower() > -kNone) out.lower = axis.Lower();
    if (!endless && axis.Upper() < kNone) out.upper = axis.Upper();
    if (!(out.lower <= out.upper)) {
      Error(line, "<lower> of " + what + " must not lie above <upper>");
    } else if (out.lower > 0 || out.upper < 0) {
      Error(line, "the limits of " + what + " must include 0, the pose in which the model is written");
    }
    if (std::isfinite(axis.Effort()) && axis.Effort() >= 0) out.max_effort = axis.Effort();
    if (std::isfinite(axis.MaxVelocity()) && axis.MaxVelocity() >= 0) out.max_velocity = axis.MaxVelocity();
    out.damping = axis.Damping();
    out.friction = axis.Friction();
    out.stiffness = axis.SpringStiffness();
    out.rest = axis.SpringReference();
    for (const auto& [name, value] : {std::pair("damping", out.damping),
                                      {"friction", out.friction},
                                      {"spring_stiffness", out.stiffness}}) {
      if (!(value >= 0) || value > 1e9) {
        Error(line, std::string("<") + name + "> of " + what + " must be a number from 0 to 1e9");
      }
    }
    if (out.friction > 0 && (out.damping > 0 || out.stiffness > 0)) {
      diagnostics_.Warning({file_, line},
                           "<friction> of " + what + " is not used beside a damper or a spring");
    }
    if (!(std::abs(out.rest) <= 1e6)) Error(line, "<spring_reference> of " + what + " must be at most 1e6");
  }

  /// Footprint and height of the collisions; nothing may reach below the floor.
  void Measure() {
    for (const LinkModel& link : robot_->links) {
      for (const LinkShape& collision : link.collisions) {
        const Pose X_RG = link.X_RL * collision.X_LG;
        const Vector3 half = HalfExtents(collision.shape, X_RG.q);
        robot_->height_m = std::max(robot_->height_m, X_RG.p.z() + half.z());
        if (!robot_->fixed_base && X_RG.p.z() - half.z() < -1e-6) {
          Error(0, "a collision of link '" + link.name + "' reaches " +
                       FormatNumber(std::round((half.z() - X_RG.p.z()) * 1e6) * 1e-3) +
                       " mm below the floor z = 0");
        }
        robot_->footprint_radius_m = std::max(robot_->footprint_radius_m, Reach(collision.shape, X_RG));
      }
    }
    if (robot_->footprint_radius_m <= 0) Error(0, "the robot has no <collision>");
  }

  /// The largest horizontal distance of a shape's points from R's z axis.
  static double Reach(const Shape& shape, const Pose& X_RG) {
    const double centre = X_RG.p.head<2>().norm();
    if (const auto* sphere = std::get_if<Sphere>(&shape)) return centre + sphere->radius_m;
    double reach = 0;
    if (const auto* box = std::get_if<Box>(&shape)) {
      for (int corner = 0; corner < 8; ++corner) {
        const Vector3 sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                           (corner & 4) != 0 ? 0.5 : -0.5);
        reach = std::max(reach, (X_RG * box->size_m.cwiseProduct(sign)).head<2>().norm());
      }
      return reach;
    }
    const auto& cylinder = std::get<Cylinder>(shape);
    const Matrix3 R = X_RG.q.toRotationMatrix();
    if (std::abs(R(2, 2)) > 1 - 1e-9) return centre + cylinder.radius_m;
    // The rims' points, closely enough: 0.1 mm at 1 m.
    constexpr int kPoints = 360;
    for (int i = 0; i < kPoints; ++i) {
      const double angle = 2 * std::numbers::pi * i / kPoints;
      for (const double end : {-0.5, 0.5}) {
        const Vector3 p(cylinder.radius_m * std::cos(angle), cylinder.radius_m * std::sin(angle),
                        end * cylinder.length_m);
        reach = std::max(reach, (X_RG * p).head<2>().norm());
      }
    }
    return reach;
  }

  const std::string file_;
  Diagnostics& diagnostics_;
  std::shared_ptr<RobotModel> robot_ = std::make_shared<RobotModel>();
  tinyxml2::XMLDocument document_;
  std::set<std::string> welded_;  // links that fixed joints hold to others
  std::vector<FixedJoint> fixed_;
  ModelLines lines_;
};

}  // namespace

std::shared_ptr<const RobotModel> ReadRobotModel(const std::filesystem::path& file,
                                                 Diagnostics& diagnostics) {
  const std::string name = file.string();
  const std::optional<std::string> text = ReadTextFile(name, {name, 0}, diagnostics);
  if (!text) return nullptr;
  return ReadRobotModelText(*text, name, file.parent_path().filename().string(), diagnostics);
}

std::shared_ptr<const RobotModel> ReadRobotModelText(const std::string& text, const std::string& file,
                                                     const std::string& type, Diagnostics& diagnostics) {
  Diagnostics found;
  std::shared_ptr<const RobotModel> robot;
  std::optional<std::string> decoded = DecodeText(text, {file, 0}, found);
  if (decoded) robot = RobotReader(file, type, found).Read(std::move(*decoded));
  diagnostics.Append(found);
  return robot;
}

}  // namespace coopdyn
