// SPDX-License-Identifier: MIT
// Adapts models made for Gazebo or ROS: `<static>`, materials, and elements that coopdyn leaves out and
// reports. For their plugins see gazebo_plugins.cc.
#include <algorithm>
#include <iterator>
#include <map>
#include <string_view>

#include "server/model/gazebo_plugins.h"
#include "server/model/model_source.h"
#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

class Adopter {
 public:
  Adopter(XmlNode& model, const Resources* resources, Diagnostics& diagnostics)
      : model_(model), resources_(resources), diagnostics_(diagnostics) {}

  void Adopt() {
    std::vector<GazeboPlugin> plugins;
    TakePlugins(model_, "", plugins);
    const std::string fixed = model_.TextOf("static");
    if (fixed == "1" || fixed == "true") MakeStatic();
    std::erase_if(model_.children, [](const XmlNode& one) { return one.name == "static"; });
    RemoveInitialPose();
    TakeScripts(model_);
    Prune(model_);
    HoldEndlessly(model_);
    if (!plugins.empty()) DropRolling(model_);
    FitViews(model_);
    ClampColors(model_);
    CutPoses(model_);
    AddAxes(model_);
    for (const auto& [what, left_out] : left_out_) {
      diagnostics_.LeftOut(left_out.first, what, left_out.count);
    }
    TranslatePlugins(plugins, resources_, model_, needless_, diagnostics_);
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

  static void TakePlugins(XmlNode& model, const std::string& scope, std::vector<GazeboPlugin>& plugins) {
    for (XmlNode& child : model.children) {
      if (child.name == "plugin") plugins.push_back({child, scope});
      if (child.name == "model") TakePlugins(child, scope + child.Attribute("name") + "::", plugins);
    }
    std::erase_if(model.children, [](const XmlNode& one) { return one.name == "plugin"; });
  }

  /// Fixes all links to the world and removes joints.
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

  /// Replaces Gazebo's own single-colour material scripts by colours.
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

  /// Replaces negative friction, which is unlimited in ODE.
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

  /// Ignores rolling friction: Gazebo's usual engines do not read it, and models have values that would stop
  /// wheels, such as half their radius.
  void DropRolling(XmlNode& node) {
    for (XmlNode& child : node.children) {
      DropRolling(child);
      if (node.name != "bullet" || child.name != "rolling_friction") continue;
      diagnostics_.Note(child.where,
                        "<rolling_friction> of <bullet> is not used, nor is it by Gazebo's usual engines");
      child.text = "0";
    }
  }

  /// Clamps fields of view: SDF's minimum is 0.1 rad, and coopdyn's images are flat.
  void FitViews(XmlNode& node) {
    constexpr double kLeast_rad = 0.1, kMost_rad = 3.05;
    for (XmlNode& child : node.children) {
      FitViews(child);
      const auto wide = child.name == "horizontal_fov" ? ParsePlain(child.text) : std::nullopt;
      if (!wide || (*wide >= kLeast_rad && *wide <= kMost_rad)) continue;
      const std::string taken = FormatNumber(*wide < kLeast_rad ? kLeast_rad : kMost_rad);
      diagnostics_.Mended(child.where, "<horizontal_fov> lies between 0.1 and 3.05 rad here: " + taken +
                                           " is taken instead of " + FormatNumber(*wide));
      child.text = taken;
    }
  }

  /// Clamps colours above 1, as older programs do.
  void ClampColors(XmlNode& node) {
    for (XmlNode& child : node.children) {
      ClampColors(child);
      constexpr std::string_view kColors[] = {"ambient", "diffuse", "specular", "emissive"};
      if (node.name != "material" || std::ranges::find(kColors, child.name) == std::end(kColors)) continue;
      std::vector<std::string> words = SplitWords(child.text);
      const auto is_above = [](const std::string& word) { return ParsePlain(word).value_or(0) > 1; };
      if (std::ranges::none_of(words, is_above)) continue;
      std::ranges::replace_if(words, is_above, "1");
      diagnostics_.Mended(child.where, "<" + child.name + "> has numbers above 1: they are taken as 1");
      child.text = Joined(words);
    }
  }

  /// Cuts poses to six numbers, as older programs do.
  void CutPoses(XmlNode& node) {
    constexpr std::size_t kNumbers = 6;
    for (XmlNode& child : node.children) {
      CutPoses(child);
      if (child.name != "pose" || child.Has("rotation_format")) continue;
      std::vector<std::string> words = SplitWords(child.text);
      if (words.size() <= kNumbers) continue;
      words.resize(kNumbers);
      diagnostics_.Mended(child.where, "<pose> has more than 6 numbers: the first 6 count");
      child.text = Joined(words);
    }
  }

  /// Adds missing axes with Gazebo's defaults.
  void AddAxes(XmlNode& node) {
    for (XmlNode& child : node.children) {
      if (child.name == "model") AddAxes(child);
      const std::string type = child.name == "joint" ? child.Attribute("type") : "";
      const bool has_two = type == "universal" || type == "revolute2";
      const bool has_one =
          type == "revolute" || type == "continuous" || type == "prismatic" || type == "screw";
      const auto add = [&](const char* axis, const char* xyz) {
        if (child.Child(axis) != nullptr) return;
        child.Add(axis, "").Add("xyz", xyz);
        diagnostics_.Mended(child.where,
                            "joint '" + child.Attribute("name") + "' has no <" + axis + ">: it is " + xyz);
      };
      if (has_one || has_two) add("axis", has_two ? "1 0 0" : "0 0 1");
      if (has_two) add("axis2", "0 1 0");
    }
  }

  /// Removes the model's pose: the scenario places the model.
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
      if (child.name == "plugin" && needless_.Take(child)) return true;
      if (IsAsHere(child)) return true;
      const bool nested_model = node.name == "model" && child.name == "pose";
      // A wrench sensor belongs in a joint, all others in links.
      const std::string type = child.Attribute("type");
      const bool unused_sensor = child.name == "sensor" &&
                                 (!IsUsedSensor(type) || (node.name == "joint") != (type == "force_torque"));
      if (nested_model || (IsUsedElement(node.name, child.name) && !unused_sensor)) return false;
      std::string what = "<" + child.name;
      if (child.Has("type")) what += " type=\"" + child.Attribute("type") + "\"";
      LeaveOut(child, what + "> in <" + node.name + ">");
      return true;
    });
    if (node.name == "geometry") {
      // Unknown shapes have been reported above; below, collisions and visuals without a shape are removed.
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

  XmlNode& model_;
  const Resources* resources_;
  Diagnostics& diagnostics_;
  NeedlessPlugins needless_;
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

void AdoptModel(XmlNode& model, const Resources* resources, Diagnostics& diagnostics) {
  Adopter(model, resources, diagnostics).Adopt();
}

}  // namespace coopdyn
