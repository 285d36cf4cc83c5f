// SPDX-License-Identifier: MIT
// Reads joints that follow other joints: <mimic> of URDF and SDF 1.11, and SDF's gearboxes.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "server/model/model_source.h"
#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// Moves the `<mimic>`s of the joints in `model` to `found`. `prefix`: of the model's names.
void TakeMimics(XmlNode& model, const std::string& prefix, std::vector<XmlNode>& found) {
  const auto take = [&](XmlNode& part, const std::string& joint) {
    for (const XmlNode& mimic : part.children) {
      if (mimic.name != "mimic") continue;
      XmlNode& made = found.emplace_back();
      made.name = "coopdyn:mimic";
      made.where = mimic.where;
      made.Set("follower", joint);
      made.Set("leader", prefix + mimic.Attribute("joint"));
      if (part.name == "axis2" || mimic.Attribute("axis") == "axis2") made.Set("axis", "axis2");
      for (const char* key : {"multiplier", "offset", "reference"}) {
        if (mimic.Child(key) != nullptr) made.Set(key, mimic.TextOf(key));
      }
    }
    std::erase_if(part.children, [](const XmlNode& one) { return one.name == "mimic"; });
  };
  for (XmlNode& child : model.children) {
    if (child.name == "model") TakeMimics(child, prefix + child.Attribute("name") + "::", found);
    if (child.name != "joint") continue;
    const std::string joint = prefix + child.Attribute("name");
    for (XmlNode& part : child.children) {
      if (part.name == "axis" || part.name == "axis2") take(part, joint);
    }
    take(child, joint);
  }
}

/// Adds the joints in `model` to `found`, by name. `prefix`: of the model's names.
void FindJoints(XmlNode& model, const std::string& prefix, std::map<std::string, XmlNode*>& found) {
  for (XmlNode& child : model.children) {
    if (child.name == "model") FindJoints(child, prefix + child.Attribute("name") + "::", found);
    if (child.name == "joint") found.emplace(prefix + child.Attribute("name"), &child);
  }
}

/// Fixes joints that follow fixed joints and removes their `mimics`. They occur in models that contain only
/// some of another model's joints.
void FixFollowers(XmlNode& model, std::vector<XmlNode>& mimics, Diagnostics& diagnostics) {
  std::map<std::string, XmlNode*> joints;
  FindJoints(model, "", joints);
  const auto is_fixed = [&](const std::string& joint) {
    const auto found = joints.find(joint);
    return found != joints.end() && found->second->Attribute("type") == "fixed";
  };
  const auto fix = [&](const XmlNode& mimic) {
    const std::string follower = mimic.Attribute("follower"), leader = mimic.Attribute("leader");
    if (is_fixed(follower)) {
      diagnostics.Note(mimic.where,
                       "<mimic> of joint '" + follower + "' is left out: a fixed joint follows nobody");
      return true;
    }
    if (!is_fixed(leader) || !joints.contains(follower)) return false;
    diagnostics.Mended(mimic.where, "joint '" + follower + "' follows the fixed joint '" + leader +
                                        "': it is taken as fixed, where the model is written");
    joints[follower]->Set("type", "fixed");
    std::erase_if(joints[follower]->children,
                  [](const XmlNode& one) { return one.name == "axis" || one.name == "axis2"; });
    return true;
  };
  std::multimap<std::string, std::size_t> ends;  // by the joints that they name
  std::deque<std::size_t> open;
  for (std::size_t i = 0; i < mimics.size(); ++i) {
    for (const char* end : {"follower", "leader"}) ends.emplace(mimics[i].Attribute(end), i);
    open.push_back(i);
  }
  std::vector<bool> is_gone(mimics.size());
  for (; !open.empty(); open.pop_front()) {
    const std::size_t i = open.front();
    if (is_gone[i] || !fix(mimics[i])) continue;
    is_gone[i] = true;
    const auto [first, end] = ends.equal_range(mimics[i].Attribute("follower"));
    for (auto other = first; other != end; ++other) open.push_back(other->second);
  }
  std::size_t next = 0;
  std::erase_if(mimics, [&](const XmlNode&) { return is_gone[next++]; });
}

void WritePitch(XmlNode& model) {
  for (XmlNode& child : model.children) {
    if (child.name == "model") WritePitch(child);
    XmlNode* const pitch = child.name == "joint" ? child.Child("screw_thread_pitch") : nullptr;
    if (pitch == nullptr) continue;
    XmlNode made = *pitch;
    made.name = "thread_pitch";
    const auto value = ParsePlain(pitch->text);
    if (value && *value != 0) made.text = FormatNumber(-2 * std::numbers::pi / *value);
    std::erase_if(child.children, [](const XmlNode& one) {
      return one.name == "thread_pitch" || one.name == "screw_thread_pitch";
    });
    child.children.push_back(std::move(made));
  }
}

class CouplingReader {
 public:
  CouplingReader(std::span<const FixedJoint> fixed, bool is_foreign, const std::string& file,
                 RobotModel& robot, Diagnostics& diagnostics)
      : fixed_(fixed), is_foreign_(is_foreign), file_(file), robot_(robot), diagnostics_(diagnostics) {}

  void Read(const tinyxml2::XMLElement& model, std::span<const Gearbox> gearboxes) {
    for (const auto* mimic = model.FirstChildElement("coopdyn:mimic"); mimic != nullptr;
         mimic = mimic->NextSiblingElement("coopdyn:mimic")) {
      ReadMimic(*mimic);
    }
    for (const Gearbox& gearbox : gearboxes) ReadGearbox(gearbox);
    const std::size_t looped = std::erase_if(couplings_, [this](Coupling& one) { return !Resolve(one); });
    if (looped > 0 && !is_foreign_) return;
    for (const Coupling& coupling : couplings_) robot_.couplings.push_back(coupling.resolved);
  }

 private:
  struct Coupling {
    CouplingModel given, resolved;
    int line = 0;
  };

  /// Reports an error; for models made for other programs a warning, and the coupling is left out.
  void Error(int line, std::string text) {
    if (is_foreign_) return diagnostics_.Warning({file_, line}, text + ". It moves on its own until then");
    diagnostics_.Error({file_, line}, std::move(text));
  }
  const JointModel& Joint(int index) const { return robot_.joints[static_cast<std::size_t>(index)]; }

  /// The joint `name`, which must have one axis. Reports an error and returns nullopt for any other.
  std::optional<int> Find(const std::string& name, int line, const std::string& what) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      const JointModel& joint = robot_.joints[i];
      if (joint.name == name && joint.has_axis()) return static_cast<int>(i);
      if (joint.has_axis()) names.push_back(joint.name);
      if (joint.name != name) continue;
      Error(line, what + " needs joints with one axis, and '" + name +
                      "' turns about more: name a revolute, continuous, prismatic or screw joint");
      return std::nullopt;
    }
    if (std::ranges::find(fixed_, name, &FixedJoint::name) != fixed_.end()) {
      Error(line, what + " names the fixed joint '" + name + "', which cannot move: remove it" +
                      (names.empty() ? "" : ", or name one of " + JoinNames(names)));
    } else {
      Error(line, what + " names no joint of this robot: '" + name + "'" + DidYouMean(name, names));
    }
    return std::nullopt;
  }

  void ReadMimic(const tinyxml2::XMLElement& mimic) {
    XmlAttributes attributes(mimic, file_, diagnostics_);
    const int line = mimic.GetLineNum();
    const std::string follower_name = attributes.Text("follower").value_or("");
    const std::string leader_name = attributes.Text("leader").value_or("");
    const std::string what = "<mimic> of joint '" + follower_name + "'";
    if (attributes.Text("axis")) {
      return Error(line, what + " follows, or leads, a second axis, which coopdyn cannot: write two joints");
    }
    double numbers[] = {1, 0, 0};
    const char* const names[] = {"multiplier", "offset", "reference"};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto text = attributes.Text(names[i]);
      if (!text) continue;
      const auto value = ParsePlain(*text);
      if (!value || std::abs(*value) > kMost) {
        return Error(line, "the " + std::string(names[i]) + " in " + what + " must be a number of at most " +
                               FormatNumber(kMost) + ", not '" + *text + "'");
      }
      numbers[i] = *value;
    }
    const auto follower = Find(follower_name, line, what), leader = Find(leader_name, line, what);
    if (!follower || !leader) return;
    if (*follower == *leader) return Error(line, what + " names the joint itself: name the one that leads");
    Add({.follower = *follower,
         .leader = *leader,
         .multiplier = numbers[0],
         .offset = numbers[1] - numbers[0] * numbers[2]},
        line);
  }

  void Add(const CouplingModel& coupling, int line) {
    if (Follows(coupling.follower)) {
      return Error(line, "joint '" + Joint(coupling.follower).name +
                             "' follows two joints: keep one <mimic> or gearbox of it");
    }
    couplings_.push_back({coupling, coupling, line});
  }
  bool Follows(int joint) const {
    return std::ranges::any_of(couplings_, [&](const Coupling& one) { return one.given.follower == joint; });
  }

  struct Side {
    int joint = 0;
    double sign = 1;  // the gearbox's angle is sign · the joint's position
  };

  /// The hinge about `axis_R` between `link` and the reference body.
  std::optional<Side> SideOf(const Gearbox& gearbox, const std::string& link, const Vector3& axis_R) {
    const std::string what = "gearbox '" + gearbox.name + "'";
    const auto index = LinkOf(link), reference = LinkOf(gearbox.reference);
    for (const auto& [found, name] : {std::pair(index, link), std::pair(reference, gearbox.reference)}) {
      if (found) continue;
      Error(gearbox.line, what + (name.empty() ? " needs <gearbox_reference_body>"
                                               : " names no link of this robot: '" + name + "'"));
      return std::nullopt;
    }
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      const JointModel& joint = robot_.joints[i];
      const bool forward = joint.parent == *reference && joint.child == *index;
      const bool backward = joint.parent == *index && joint.child == *reference;
      if (joint.kind != JointModel::Kind::kHinge || (!forward && !backward)) continue;
      const double along = joint.axis_R.dot(axis_R);
      if (std::abs(along) < 1 - 1e-3) {
        Error(gearbox.line, "the axes of " + what + " must lie along those of the joints that it couples; " +
                                "that of '" + joint.name + "' does not");
        return std::nullopt;
      }
      return Side{static_cast<int>(i), (along > 0) == forward ? 1.0 : -1.0};
    }
    Error(gearbox.line, what + " needs a revolute joint between its reference body '" + gearbox.reference +
                            "' and '" + link + "': write one");
    return std::nullopt;
  }

  std::optional<int> LinkOf(const std::string& name) const {
    if (name == "world" && robot_.fixed_base) return 0;
    const auto found = std::ranges::find(robot_.frames, name, &FrameModel::name);
    return found == robot_.frames.end() ? std::nullopt : std::optional(found->link);
  }

  void ReadGearbox(const Gearbox& gearbox) {
    if (!(std::abs(gearbox.ratio) >= 1 / kMost && std::abs(gearbox.ratio) <= kMost)) {
      return Error(gearbox.line, "<gearbox_ratio> of '" + gearbox.name + "' must be a number, not 0");
    }
    const auto parent = SideOf(gearbox, gearbox.parent, gearbox.axis_R);
    if (!parent) return;
    const auto child = SideOf(gearbox, gearbox.child, gearbox.axis2_R);
    if (!child) return;
    if (parent->joint == child->joint) {
      return Error(gearbox.line,
                   "gearbox '" + gearbox.name + "' couples a joint with itself: name two links");
    }
    const double multiplier = -gearbox.ratio * parent->sign * child->sign;
    // The side with a motor leads, or the side that already follows another joint.
    const auto has_motor = [this](int joint) { return std::isfinite(Joint(joint).max_effort); };
    const bool swapped = Follows(child->joint) ||
                         (has_motor(child->joint) && !has_motor(parent->joint) && !Follows(parent->joint));
    CouplingModel coupling{.follower = child->joint, .leader = parent->joint, .multiplier = multiplier};
    if (swapped) coupling = {.follower = parent->joint, .leader = child->joint, .multiplier = 1 / multiplier};
    Add(coupling, gearbox.line);
  }

  /// Replaces a coupling's leader by the first leader that follows no joint. False in a loop.
  bool Resolve(Coupling& coupling) {
    CouplingModel& made = coupling.resolved;
    for (std::size_t steps = 0; steps <= couplings_.size(); ++steps) {
      const auto next = std::ranges::find_if(
          couplings_, [&](const Coupling& one) { return one.given.follower == made.leader; });
      if (next == couplings_.end()) return true;
      made.leader = next->given.leader;
      made.offset += made.multiplier * next->given.offset;
      made.multiplier *= next->given.multiplier;
    }
    Error(coupling.line,
          "joint '" + Joint(made.follower).name +
              "' follows joints that follow each other in a loop: remove one <mimic> or gearbox");
    return false;
  }

  static constexpr double kMost = 1e6;

  std::span<const FixedJoint> fixed_;
  const bool is_foreign_;
  const std::string& file_;
  RobotModel& robot_;
  Diagnostics& diagnostics_;
  std::vector<Coupling> couplings_;
};

}  // namespace

void GatherMimics(XmlNode& model, bool is_foreign, Diagnostics& diagnostics) {
  std::vector<XmlNode> found;
  TakeMimics(model, "", found);
  if (is_foreign) FixFollowers(model, found, diagnostics);
  for (XmlNode& mimic : found) model.children.push_back(std::move(mimic));
  WritePitch(model);
}

void ReadCouplings(const tinyxml2::XMLElement& model, std::span<const Gearbox> gearboxes,
                   std::span<const FixedJoint> fixed, bool is_foreign, const std::string& file,
                   RobotModel& robot, Diagnostics& diagnostics) {
  CouplingReader(fixed, is_foreign, file, robot, diagnostics).Read(model, gearboxes);
}

}  // namespace coopdyn
