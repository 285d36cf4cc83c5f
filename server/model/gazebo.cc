// SPDX-License-Identifier: MIT
// What models made for Gazebo or ROS say in its own way: plug-ins for drives and joints, `<static>`, and the
// rest that coopdyn leaves out and reports.
#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "server/model/model_source.h"
#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr const char* kDriveWords[] = {"diff_drive",         "DiffDrive", "diff-drive",
                                       "differential_drive", "ackermann", "Ackermann"};
constexpr const char* kJointWords[] = {"joint-position-controller",
                                       "JointPositionController",
                                       "joint-controller",
                                       "JointController",
                                       "joint_position",
                                       "joint_pose_trajectory",
                                       "JointTrajectoryController",
                                       "joint-trajectory-controller"};

template <typename Words>
bool HasWord(const std::string& text, const Words& words) {
  return std::ranges::any_of(words, [&](const char* word) { return text.find(word) != std::string::npos; });
}

/// The text of the first of these elements that is there.
std::string FirstOf(const XmlNode& node, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (!node.TextOf(name).empty()) return node.TextOf(name);
  }
  return {};
}

/// Of the elements with these names the texts behind the first one, with blanks between.
std::string OthersOf(const XmlNode& node, std::initializer_list<std::string_view> names) {
  std::string others;
  bool first = true;
  for (const XmlNode& child : node.children) {
    const bool named = std::ranges::find(names, child.name) != names.end() && !child.text.empty();
    if (named && !std::exchange(first, false)) others += " " + child.text;
  }
  return others;
}

class Adopter {
 public:
  Adopter(XmlNode& model, Diagnostics& diagnostics) : model_(model), diagnostics_(diagnostics) {}

  void Adopt() {
    std::vector<XmlNode> plugins;
    TakePlugins(model_, plugins);
    const std::string fixed = model_.TextOf("static");
    if (fixed == "1" || fixed == "true") MakeStatic();
    std::erase_if(model_.children, [](const XmlNode& one) { return one.name == "static"; });
    RemoveInitialPose();
    TakeScripts(model_);
    Prune(model_);
    HoldEndlessly(model_);
    for (const auto& [what, left_out] : left_out_) {
      diagnostics_.LeftOut(left_out.first, what, left_out.count);
    }
    for (const XmlNode& plugin : plugins) Translate(plugin);
  }

 private:
  struct LeftOut {
    SourceLine first;
    int count = 0;
  };

  void LeaveOut(const XmlNode& node, const std::string& what) {
    LeftOut& entry = left_out_[what];
    if (entry.count++ == 0) entry.first = node.where;
  }

  static void TakePlugins(XmlNode& model, std::vector<XmlNode>& plugins) {
    for (XmlNode& child : model.children) {
      if (child.name == "plugin") plugins.push_back(child);
      if (child.name == "model") TakePlugins(child, plugins);
    }
    std::erase_if(model.children, [](const XmlNode& one) { return one.name == "plugin"; });
  }

  /// Links that stand where they are; joints have nothing to move.
  void MakeStatic() {
    std::vector<std::pair<std::string, SourceLine>> links;
    CollectLinks(model_, "", links);
    std::erase_if(model_.children,
                  [](const XmlNode& one) { return one.name == "joint" || one.name == "coopdyn:mimic"; });
    std::string parent = "world";
    int number = 0;
    for (const auto& [link, where] : links) {
      XmlNode& joint = model_.Add("joint");
      joint.where = where;
      joint.Set("name", "coopdyn_static_" + std::to_string(++number));
      joint.Set("type", "fixed");
      joint.Add("parent", parent);
      joint.Add("child", link);
      parent = links.front().first;
    }
  }

  static void CollectLinks(XmlNode& model, const std::string& prefix,
                           std::vector<std::pair<std::string, SourceLine>>& links) {
    for (XmlNode& child : model.children) {
      if (child.name == "link") links.emplace_back(prefix + child.Attribute("name"), child.where);
      if (child.name != "model") continue;
      std::erase_if(child.children, [](const XmlNode& one) { return one.name == "joint"; });
      CollectLinks(child, prefix + child.Attribute("name") + "::", links);
    }
  }

  /// Materials of Gazebo's own scripts that are one colour.
  static void TakeScripts(XmlNode& node) {
    for (XmlNode& child : node.children) TakeScripts(child);
    const XmlNode* script = node.name == "material" ? node.Child("script") : nullptr;
    if (script == nullptr) return;
    const std::string name = script->TextOf("name").empty() ? script->text : script->TextOf("name");
    const auto color = GazeboColor(name);
    if (!color) return;
    if (node.Child("diffuse") == nullptr) node.Add("diffuse", *color);
    std::erase_if(node.children, [](const XmlNode& one) { return one.name == "script"; });
  }

  /// ODE's word for friction without end is a negative one.
  void HoldEndlessly(XmlNode& node) {
    for (XmlNode& child : node.children) {
      HoldEndlessly(child);
      const auto mu = child.name == "mu" || child.name == "mu2" ? ParsePlain(child.text) : std::nullopt;
      if (!mu || *mu >= 0) continue;
      child.text = "1000";
      if (!std::exchange(says_endless_, true))
        diagnostics_.Mended(child.where,
                            "<" + child.name + "> below 0 is taken as 1000, friction that nothing overcomes");
    }
  }

  /// Where it stands is for the scenario to say.
  void RemoveInitialPose() {
    std::erase_if(model_.children, [this](const XmlNode& one) {
      if (one.name != "pose") return false;
      const std::vector<std::string> words = SplitWords(one.text);
      const bool origin =
          std::ranges::all_of(words, [](const std::string& w) { return ParsePlain(w).value_or(1) == 0; });
      if (!origin)
        diagnostics_.Note(one.where, "<pose> of the whole model is not used: write position in the scenario");
      return true;
    });
  }

  void Prune(XmlNode& node) {
    std::erase_if(node.children, [&](const XmlNode& child) {
      if (child.name.starts_with("coopdyn:")) return false;
      if (IsAsHere(child)) return true;
      const bool nested_model = node.name == "model" && child.name == "pose";
      const bool unused_sensor = child.name == "sensor" && !IsUsedSensor(child.Attribute("type"));
      if (nested_model || (IsUsedElement(node.name, child.name) && !unused_sensor)) return false;
      std::string what = "<" + child.name;
      if (child.Has("type")) what += " type=\"" + child.Attribute("type") + "\"";
      LeaveOut(child, what + "> in <" + node.name + ">");
      return true;
    });
    if (node.name == "geometry") {
      // Each shape that coopdyn does not know was said above; what is around it goes, too.
      for (XmlNode& shape : node.children) Prune(shape);
      return;
    }
    for (XmlNode& child : node.children) Prune(child);
    if (node.name != "link") return;
    std::erase_if(node.children, [&](const XmlNode& child) {
      if (child.name != "collision" && child.name != "visual") return false;
      const XmlNode* geometry = child.Child("geometry");
      if (geometry != nullptr && !geometry->children.empty()) return false;
      LeaveOut(child, "<" + child.name + "> without a shape that coopdyn knows");
      return true;
    });
  }

  void Translate(const XmlNode& plugin) {
    const std::string what = plugin.Attribute("filename") + " " + plugin.Attribute("name");
    const std::string shown = "plug-in '" + plugin.Attribute("filename") + "'";
    const std::string left = FirstOf(plugin, {"left_joint", "leftJoint", "rear_left_joint"});
    const std::string right = FirstOf(plugin, {"right_joint", "rightJoint", "rear_right_joint"});
    if (HasWord(what, kDriveWords) && !left.empty() && !right.empty()) {
      if (model_.Child("coopdyn:gazebo_drive") != nullptr) {
        diagnostics_.LeftOut(plugin.where, "a second differential drive");
        return;
      }
      XmlNode& drive = model_.Add("coopdyn:gazebo_drive");
      drive.where = plugin.where;
      drive.Set("left_joint", left);
      drive.Set("right_joint", right);
      drive.Set("other_left_joints", OthersOf(plugin, {"left_joint", "leftJoint"}));
      drive.Set("other_right_joints", OthersOf(plugin, {"right_joint", "rightJoint"}));
      for (const auto& [key, text] :
           {std::pair("steer_left", FirstOf(plugin, {"left_steering_joint"})),
            std::pair("steer_right", FirstOf(plugin, {"right_steering_joint"})),
            std::pair("steering_limit", FirstOf(plugin, {"steering_limit", "max_steer"})),
            std::pair("torque", FirstOf(plugin, {"max_wheel_torque", "wheelTorque", "torque"})),
            std::pair("diameter", FirstOf(plugin, {"wheel_diameter", "wheelDiameter"})),
            std::pair("radius", FirstOf(plugin, {"wheel_radius"}))}) {
        if (!text.empty()) drive.Set(key, text);
      }
      return;
    }
    bool moves = false;
    for (const XmlNode& named : plugin.children) {
      const bool names = named.name == "joint_name" || named.name == "jointName" || named.name == "joint";
      if (!HasWord(what, kJointWords) || !names || named.text.empty()) continue;
      moves = true;
      XmlNode& moved = model_.Add("coopdyn:gazebo_joint");
      moved.where = plugin.where;
      moved.Set("joint", named.text);
      const std::string effort = FirstOf(plugin, {"cmd_max"});
      if (!effort.empty()) moved.Set("effort", effort);
    }
    // Its joints stand in <ros2_control> or in <transmission>s.
    const bool is_ros =
        what.find("ros_control") != std::string::npos || what.find("ros2_control") != std::string::npos;
    if (moves || (is_ros && model_.Child("coopdyn:gazebo_joint") != nullptr)) return;
    diagnostics_.LeftOut(plugin.where, shown);
  }

  XmlNode& model_;
  Diagnostics& diagnostics_;
  std::map<std::string, LeftOut> left_out_;
  bool says_endless_ = false;
};

}  // namespace

bool IsAsHere(const XmlNode& node) {
  const bool on = node.text == "1" || node.text == "true", off = node.text == "0" || node.text == "false";
  if (node.name == "gravity") return on;
  constexpr std::string_view kOff[] = {"self_collide", "selfCollide", "kinematic", "enable_wind",
                                       "turnGravityOff"};
  return off && std::ranges::find(kOff, node.name) != std::end(kOff);
}

std::optional<std::string> GazeboColor(const std::string& material) {
  constexpr std::string_view kOwner = "Gazebo/";
  if (!material.starts_with(kOwner)) return std::nullopt;
  std::string word = material.substr(kOwner.size());
  if (word.starts_with("Flat")) word.erase(0, 4);
  for (const std::string_view end : {"Transparent", "Bright", "Glow", "TransparentOverlay"}) {
    if (word.ends_with(end)) word.resize(word.size() - end.size());
  }
  const auto color = word == "Turquoise" || word == "SkyBlue" ? Color{0.25, 0.75, 0.8} : NamedColor(word);
  if (!color) return std::nullopt;
  return FormatNumber(color->r) + " " + FormatNumber(color->g) + " " + FormatNumber(color->b) + " 1";
}

void AdoptModel(XmlNode& model, Diagnostics& diagnostics) {
  Adopter(model, diagnostics).Adopt();
}

}  // namespace coopdyn
