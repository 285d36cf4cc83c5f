// SPDX-License-Identifier: MIT
// Reads the joints of a robot.
#include <spdlog/fmt/fmt.h>
#include <tinyxml2.h>
#include <algorithm>
#include <cmath>
#include <optional>
#include <sdf/sdf.hh>

#include "server/model/sdf_body.h"
#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr double kNoLimit = 1e15;  // limits from here on mean unlimited
constexpr double kFar = 1e6;       // rad or m: maximum distance of a joint from 0

using Kind = JointModel::Kind;

class JointReader {
 public:
  explicit JointReader(ModelReading& reading) : reading_(reading) {}

  void Read(const std::vector<ModelScope>& scopes) {
    for (const ModelScope& scope : scopes) {
      for (std::size_t i = 0; i < scope.model.JointCount(); ++i) ReadOne(scope, *scope.model.JointByIndex(i));
    }
    if (!reading_.source.foreign && !world_) return;
    // All links fixed to the world form one base.
    std::optional<int> base;
    for (FixedJoint& fixed : reading_.fixed) {
      if (fixed.parent != FixedJoint::kWorld) continue;
      if (base && *base != fixed.child) fixed.parent = *base;
      if (!base) base = fixed.child;
    }
  }

 private:
  /// nullopt for fixed joints, gearboxes and unknown types.
  static std::optional<Kind> KindOf(sdf::JointType type) {
    switch (type) {
      case sdf::JointType::PRISMATIC:
        return Kind::kSlider;
      case sdf::JointType::REVOLUTE:
      case sdf::JointType::CONTINUOUS:
        return Kind::kHinge;
      case sdf::JointType::UNIVERSAL:
        return Kind::kUniversal;
      case sdf::JointType::BALL:
        return Kind::kBall;
      case sdf::JointType::SCREW:
        return Kind::kScrew;
      default:
        return std::nullopt;
    }
  }

  /// Index of a link, or FixedJoint::kWorld for the world; nullopt if unknown.
  std::optional<int> FindEnd(const std::string& prefix, const std::string& name) const {
    if (name == "world") return FixedJoint::kWorld;
    const auto& links = reading_.robot.links;
    const auto found = std::ranges::find(links, prefix + name, &LinkModel::name);
    if (found == links.end()) return std::nullopt;
    return static_cast<int>(found - links.begin());
  }

  /// The link that represents the world as a parent of joints, added on first use.
  int WorldLink(int line) {
    if (world_) return *world_;
    world_ = static_cast<int>(reading_.robot.links.size());
    LinkModel link;
    link.name = "world";
    link.mass_kg = 1;
    link.inertia_kg_m2 = Vector3::Ones();
    reading_.assembly.links.push_back({link.name});
    reading_.robot.links.push_back(std::move(link));
    reading_.lines.links.push_back(line);
    reading_.fixed.push_back({FixedJoint::kWorld, *world_, line});
    return *world_;
  }

  /// The joint's element; null if none has its name.
  static const tinyxml2::XMLElement* XmlOf(const ModelScope& scope, const sdf::Joint& joint) {
    for (const auto* xml = scope.xml.FirstChildElement("joint"); xml != nullptr;
         xml = xml->NextSiblingElement("joint")) {
      const char* name = xml->Attribute("name");
      if (name != nullptr && name == joint.Name()) return xml;
    }
    return nullptr;
  }

  /// The joint's original name.
  static std::string NameOf(const ModelScope& scope, const sdf::Joint& joint) {
    const tinyxml2::XMLElement* const xml = XmlOf(scope, joint);
    const char* const given = xml == nullptr ? nullptr : xml->Attribute("coopdyn:name");
    return given == nullptr ? joint.Name() : given;
  }

  void ReadTrains(const ModelScope& scope, const sdf::Joint& joint, JointModel& out) {
    const tinyxml2::XMLElement* const xml = XmlOf(scope, joint);
    for (const auto* one = xml == nullptr ? nullptr : xml->FirstChildElement("coopdyn:drivetrain");
         one != nullptr; one = one->NextSiblingElement("coopdyn:drivetrain")) {
      ReadDriveTrain(*one, reading_.file, out, reading_.diagnostics);
    }
  }

  void ReadOne(const ModelScope& scope, const sdf::Joint& joint) {
    const int line = LineOf(joint.Element());
    const std::string name = scope.prefix + NameOf(scope, joint);
    const std::string what = "joint '" + name + "'";
    if (joint.Type() == sdf::JointType::GEARBOX) return ReadGearbox(scope, joint, line, what);
    const bool fixed = joint.Type() == sdf::JointType::FIXED;
    const std::optional<Kind> kind = KindOf(joint.Type());
    if (!fixed && !kind) {
      reading_.Complain(
          line,
          what + " must be of type revolute, continuous, prismatic, screw, universal, ball, gearbox or fixed",
          "it is taken as fixed", Diagnostic::Level::kWarning);
      if (!reading_.source.foreign) return;
    }
    std::string parent, child;
    for (const sdf::Error& e : joint.ResolveParentLink(parent)) reading_.Error(line, e.Message());
    for (const sdf::Error& e : joint.ResolveChildLink(child)) reading_.Error(line, e.Message());
    std::optional<int> from = FindEnd(scope.prefix, parent), to = FindEnd(scope.prefix, child);
    if (!from || !to || *to == FixedJoint::kWorld || *from == *to) {
      reading_.Error(
          line, what + " needs <parent> and <child> that are two links of this model; <parent> may be world");
      return;
    }
    const Pose X_RJ = scope.X_RM * reading_.Resolve(joint.SemanticPose(), "__model__", joint.Element(), what);
    if (fixed || !kind) {
      reading_.fixed.push_back({*from, *to, line, name});
      AddToAssembly(name, *to, X_RJ);
      return;
    }
    if (*from == FixedJoint::kWorld) from = WorldLink(line);
    JointModel out;
    out.name = name;
    out.kind = *kind;
    out.parent = *from;
    out.child = *to;
    out.p_RJ = X_RJ.p;
    if (*kind == Kind::kBall || *kind == Kind::kUniversal) out.max_effort = 0;  // no motor
    if (*kind != Kind::kBall) {
      const auto axis = AxisOf(scope, joint, 0, line, what);
      if (!axis) return;
      out.axis_R = *axis;
    }
    if (*kind == Kind::kUniversal) {
      const auto axis = AxisOf(scope, joint, 1, line, what);
      if (!axis) return;
      out.axis2_R = *axis;
      if (std::abs(out.axis2_R.dot(out.axis_R)) > 1e-3) {
        reading_.Error(line, "the axes of " + what + " must be at right angles");
        return;
      }
    }
    if (*kind == Kind::kScrew) ReadPitch(joint, line, what, out);
    if (out.has_axis()) {
      constexpr double kMostArmature = 1e6;
      const auto start = NumberOf(scope, joint, line, "coopdyn:start", -kFar, kFar,
                                  "the position where it starts, a number of rad or m");
      out.armature = NumberOf(scope, joint, line, "coopdyn:armature", 0, kMostArmature,
                              "the inertia of its motor as the joint feels it, 0 to 1e6 kg m² (kg of one "
                              "that slides)")
                         .value_or(0);
      ReadAxis(*joint.Axis(0), joint.Type() == sdf::JointType::CONTINUOUS, start, line, out);
    } else {
      WarnPassive(joint, XmlOf(scope, joint), line, what);
    }
    ReadTrains(scope, joint, out);
    reading_.robot.joints.push_back(std::move(out));
    reading_.lines.joints.push_back(line);
    AddToAssembly(name, *to, X_RJ);
  }

  /// ReadAssembly() adds the parent later.
  void AddToAssembly(const std::string& name, int child, const Pose& X_RJ) {
    const Pose& X_RF = reading_.robot.links[static_cast<std::size_t>(child)].X_RL;
    reading_.assembly.joints.push_back({name, 0, child, X_RF.Inverse() * X_RJ});
  }

  /// Reads the older <thread_pitch>: rad/m, positive for a left-handed thread.
  void ReadPitch(const sdf::Joint& joint, int line, const std::string& what, JointModel& out) {
    const double pitch_rad_m = joint.Element()->HasElement("thread_pitch") ? joint.ThreadPitch() : 0;
    constexpr double kLeast = 1e-6, kMost = 1e9;
    if (!(std::abs(pitch_rad_m) >= kLeast && std::abs(pitch_rad_m) <= kMost)) {
      reading_.Error(line, what +
                               " needs <screw_thread_pitch>: metres along the axis per revolution, not 0, "
                               "positive for a right-handed thread");
      return;
    }
    out.pitch_m_rad = -1 / pitch_rad_m;
  }

  /// Reads a gearbox. It is not a joint: ReadCouplings() makes it a coupling.
  void ReadGearbox(const ModelScope& scope, const sdf::Joint& joint, int line, const std::string& what) {
    const sdf::ElementPtr element = joint.Element();
    const auto axis = AxisOf(scope, joint, 0, line, what), axis2 = AxisOf(scope, joint, 1, line, what);
    if (!axis || !axis2) return;
    const auto link = [&](const std::string& name) {
      return name.empty() || name == "world" ? name : scope.prefix + name;
    };
    Gearbox gearbox{.name = scope.prefix + NameOf(scope, joint),
                    .parent = link(joint.ParentLinkName()),
                    .child = link(joint.ChildLinkName()),
                    .reference = {},
                    .axis_R = *axis,
                    .axis2_R = *axis2,
                    .ratio = 1,
                    .line = line};
    if (element->HasElement("gearbox_reference_body"))
      gearbox.reference = link(element->Get<std::string>("gearbox_reference_body"));
    if (element->HasElement("gearbox_ratio")) gearbox.ratio = element->Get<double>("gearbox_ratio");
    reading_.gearboxes.push_back(std::move(gearbox));
  }

  std::optional<Vector3> AxisOf(const ModelScope& scope, const sdf::Joint& joint, unsigned index, int line,
                                const std::string& what) {
    const sdf::JointAxis* axis = joint.Axis(index);
    if (axis == nullptr) {
      reading_.Error(line, what + (index == 0 ? " needs an <axis>" : " needs an <axis2>"));
      return std::nullopt;
    }
    ignition::math::Vector3d xyz;
    for (const sdf::Error& e : axis->ResolveXyz(xyz, "__model__")) reading_.Error(line, e.Message());
    const Vector3 direction = ToVector(xyz);
    if (!direction.allFinite() || direction.norm() < 1e-9) {
      reading_.Error(line, "the axis of " + what + " has no direction");
      return std::nullopt;
    }
    return scope.X_RM.q * direction.normalized();
  }

  /// Warns about unused elements of a ball or universal joint, which turns freely.
  void WarnPassive(const sdf::Joint& joint, const tinyxml2::XMLElement* xml, int line,
                   const std::string& what) {
    if (xml != nullptr && xml->Attribute("coopdyn:armature") != nullptr)
      reading_.Warn(line, "coopdyn:armature of " + what + " is not used: only a joint with one axis has it");
    for (const unsigned index : {0u, 1u}) {
      const sdf::JointAxis* axis = joint.Axis(index);
      if (axis == nullptr) continue;
      const bool stops = axis->Lower() > -kNoLimit || axis->Upper() < kNoLimit;
      if (!stops && axis->Damping() == 0 && axis->Friction() == 0 && axis->SpringStiffness() == 0) continue;
      reading_.Warn(line,
                    "<limit> and <dynamics> of " + what +
                        " are not used: it turns freely; write two revolute joints for stops or a motor");
      return;
    }
  }

  /// Reads the motor's `limit` from <effort> or <velocity>; infinite if missing or negative. In a model made
  /// for other programs, a limit of kNoLimit or more stays until plugins may set one.
  void ReadMotorLimit(const char* name, double value, double most, const std::string& what, int line,
                      double& limit) {
    limit =
        value >= kNoLimit && (reading_.source.foreign || std::isinf(value)) ? value : std::min(value, most);
    if (value == 0) {
      reading_.Warn(line, fmt::format("<{}> of {} is 0: it has no motor and moves freely", name, what));
    } else if (value > most && std::isfinite(value)) {
      WarnMost(name, value < kNoLimit ? FormatNumber(value) : "no limit", most, what, line);
    }
  }

  void WarnMost(const char* name, const std::string& given, double most, const std::string& what, int line) {
    reading_.Mended(line, fmt::format("<{}> of {} is {}: its motor has {} at most", name, what, given,
                                      FormatNumber(most)));
  }

  void ReadMotor(const sdf::JointAxis& axis, const std::string& what, int line, JointModel& out) {
    double &effort = out.max_effort, &velocity = out.max_velocity;
    ReadMotorLimit("effort", axis.Effort(), kMaxMotorEffort, what, line, effort);
    ReadMotorLimit("velocity", axis.MaxVelocity(), kMaxMotorVelocity, what, line, velocity);
    if (!reading_.source.foreign || effort == 0 || velocity == 0) return;
    const sdf::ElementPtr limit = axis.Element()->FindElement("limit");
    if (std::isinf(effort) && std::isinf(velocity)) {
      if (limit != nullptr && (limit->HasElement("effort") || limit->HasElement("velocity")))
        reading_.Warn(line, "<effort> and <velocity> of " + what +
                                " are negative and give it no motor: write the most that its motor has");
    } else if (std::isinf(velocity)) {
      velocity = kNoLimit;
      WarnMost("velocity", "no limit", kMaxMotorVelocity, what, line);
    } else if (std::isinf(effort)) {
      effort = kNoLimit;
      WarnMost("effort", "no limit", kMaxMotorEffort, what, line);
    }
  }

  /// The number in an attribute of a joint; nullopt if missing or invalid (then reported).
  std::optional<double> NumberOf(const ModelScope& scope, const sdf::Joint& joint, int line,
                                 const char* attribute, double least, double most, const char* meaning) {
    const tinyxml2::XMLElement* const xml = XmlOf(scope, joint);
    const char* const text = xml == nullptr ? nullptr : xml->Attribute(attribute);
    if (text == nullptr) return std::nullopt;
    const std::optional<double> number = ParsePlain(text);
    if (number && *number >= least && *number <= most) return number;
    reading_.Error(line,
                   fmt::format("{} of joint '{}' is {}, not '{}'", attribute, joint.Name(), meaning, text));
    return std::nullopt;
  }

  /// `start`: the model's start position, if it has one.
  void ReadAxis(const sdf::JointAxis& axis, bool endless, const std::optional<double>& start, int line,
                JointModel& out) {
    const std::string what = "joint '" + out.name + "'";
    if (!endless && axis.Lower() > -kNoLimit) out.lower = axis.Lower();
    if (!endless && axis.Upper() < kNoLimit) out.upper = axis.Upper();
    const bool crossed = !(out.lower <= out.upper);
    if (crossed || out.lower > kFar || out.upper < -kFar) {
      reading_.Complain(line,
                        crossed ? "<lower> of " + what + " must not lie above <upper>"
                                : "the stops of " + what + " leave out all that is near 0",
                        "it has no stops");
      out.lower = -JointModel::kInfinity;
      out.upper = JointModel::kInfinity;
    } else if (start) {
      out.start = std::clamp(*start, out.lower, out.upper);
    } else if (out.lower > 0 || out.upper < 0) {
      out.start = out.lower > 0 ? out.lower : out.upper;
      reading_.Mended(
          line, what + " starts at " + FormatNumber(std::round(out.start * 1e4) / 1e4) +
                    ", its nearest limit: its limits leave out 0, the pose in which the model is written");
    }
    ReadMotor(axis, what, line, out);
    out.damping = axis.Damping();
    out.friction = axis.Friction();
    out.stiffness = axis.SpringStiffness();
    out.rest = axis.SpringReference();
    constexpr double kMost = 1e9;
    for (const auto& [name, value] : {std::pair("damping", &out.damping),
                                      {"friction", &out.friction},
                                      {"spring_stiffness", &out.stiffness}}) {
      const std::string wrong = std::string("<") + name + "> of " + what + " must be a number from 0 to 1e9";
      if (*value > kMost) {  // used by some models to hold a joint
        reading_.Complain(line, wrong, "it is 1e9");
        *value = kMost;
      } else if (!(*value >= 0)) {
        reading_.Error(line, wrong);
      }
    }
    if (!(std::abs(out.rest) <= kFar))
      reading_.Error(line, "<spring_reference> of " + what + " must be at most 1e6");
  }

  ModelReading& reading_;
  std::optional<int> world_;
};

}  // namespace

void ReadJoints(const std::vector<ModelScope>& scopes, ModelReading& reading) {
  JointReader(reading).Read(scopes);
}

}  // namespace coopdyn
