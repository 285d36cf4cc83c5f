// SPDX-License-Identifier: MIT
// Rewrites elements of older and newer SDF as SDF 1.9.
#include <optional>
#include <string>
#include <utility>

#include "server/model/model_source.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// Rewrites the noise of an <imu> in SDF 1.5, which has one for the turn rates and one for the accelerations.
void UpgradeImu(XmlNode& imu) {
  const XmlNode* noise = imu.Child("noise");
  if (noise == nullptr) return;
  const XmlNode old = *noise;
  std::erase_if(imu.children, [](const XmlNode& one) { return one.name == "noise" || one.name == "topic"; });
  for (const auto& [from, to] : {std::pair("rate", "angular_velocity"), {"accel", "linear_acceleration"}}) {
    const XmlNode* values = old.Child(from);
    if (values == nullptr) continue;
    XmlNode& made = imu.Add(to);
    for (const char* axis : {"x", "y", "z"}) {
      XmlNode& one = made.Add(axis).Add("noise");
      one.Set("type", old.TextOf("type").empty() ? "gaussian" : old.TextOf("type"));
      one.children = values->children;
    }
  }
}

/// Replaces `inf` by `most`.
void WriteEndless(XmlNode& node, const std::string& most) {
  std::string text = ToLower(node.text);
  const std::string sign = text.starts_with('-') ? "-" : "";
  if (text.starts_with('-') || text.starts_with('+')) text.erase(0, 1);
  if (text == "inf" || text == "infinity") node.text = sign + most;
}

/// Rewrites <inertial auto="true"> of SDF 1.11: moves the densities of the link's collisions to attributes.
void UpgradeInertia(XmlNode& link) {
  XmlNode* const inertial = link.Child("inertial");
  if (inertial == nullptr || !inertial->Has("auto")) return;
  const bool is_auto = inertial->Attribute("auto") == "true" || inertial->Attribute("auto") == "1";
  inertial->Remove("auto");
  const auto take = [](XmlNode& from, const std::string& otherwise) {
    const std::string given = from.TextOf("density");
    std::erase_if(from.children, [](const XmlNode& one) {
      return one.name == "density" || one.name == "auto_inertia_params";
    });
    return given.empty() ? otherwise : given;
  };
  const std::string common = take(*inertial, "1000");  // kg/m³, SDF's default: water
  for (XmlNode& child : link.children) {
    if (child.name != "collision") continue;
    const std::string density = take(child, common);
    if (is_auto) child.Set(kDensityAttribute, density);
  }
  if (!is_auto) return;
  inertial->children.clear();
  inertial->Set(kWeighAttribute, "true");
}

}  // namespace

std::optional<int> MinorOf(const std::string& version) {
  if (!version.starts_with("1.") || version.size() > 4) return std::nullopt;
  const auto minor = ParsePlain(version.substr(2));
  if (!minor || *minor < 0 || version.find_first_not_of("0123456789.") != std::string::npos)
    return std::nullopt;
  return static_cast<int>(*minor);
}

void Upgrade(XmlNode& node, const std::string& version) {
  if (node.name == "imu") UpgradeImu(node);
  if (node.name == "link") UpgradeInertia(node);
  // Infinite ranges become further than any sensor sees.
  if (XmlNode* max = node.name == "range" ? node.Child("max") : nullptr; max != nullptr)
    WriteEndless(*max, "100000");
  if (node.name == "limit") {
    for (XmlNode& child : node.children) WriteEndless(child, "1e16");
  }
  if (node.name == "mu" || node.name == "mu2") WriteEndless(node, "1e16");
  const int minor = MinorOf(version).value_or(9);
  if (node.name == "sdf") node.Set("version", "1.9");
  if (minor < 7) {
    if (node.Has("frame") && node.name == "pose") {
      const std::string frame = node.Attribute("frame");
      node.Remove("frame");
      if (!frame.empty()) node.Set("relative_to", frame);
    }
    if (node.name == "axis" || node.name == "axis2") {
      const std::string flag = node.TextOf("use_parent_model_frame");
      const bool in_model = minor < 5 || flag == "1" || flag == "true";
      std::erase_if(node.children, [](const XmlNode& one) {
        return one.name == "use_parent_model_frame" || one.name == "initial_position";
      });
      XmlNode* xyz = node.Child("xyz");
      if (in_model && xyz != nullptr) xyz->Set("expressed_in", "__model__");
    }
  }
  for (XmlNode& child : node.children) Upgrade(child, version);
}

}  // namespace coopdyn
