// SPDX-License-Identifier: MIT
// Resolves placement_frame: the frame of a model that its <pose> places, instead of the model's own
// (http://sdformat.org, Pose frame semantics).
#include <cmath>
#include <numbers>

#include "server/base/printable.h"
#include "server/model/model_source.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr int kMostDeep = 100;

/// X_MF of the frame `name` in `model`; nullopt if it does not exist or frames refer to each other in a loop.
std::optional<Pose> FrameIn(const XmlNode& model, const std::string& name, int depth = 0) {
  if (name.empty() || name == "__model__") return Pose();
  if (depth > kMostDeep) return std::nullopt;
  const std::size_t colons = name.find("::");
  for (const XmlNode& child : model.children) {
    const bool is_framed =
        child.name == "link" || child.name == "frame" || child.name == "joint" || child.name == "model";
    if (!is_framed || child.Attribute("name") != name.substr(0, colons)) continue;
    const XmlNode* const pose = child.Child("pose");
    std::string base = pose == nullptr ? "" : pose->Attribute("relative_to");
    if (base.empty()) base = child.name == "joint" ? child.TextOf("child") : child.Attribute("attached_to");
    const auto X_MB = FrameIn(model, base, depth + 1);
    if (!X_MB) return std::nullopt;
    const Pose X_MC = *X_MB * PoseOf(pose);
    if (colons == std::string::npos) return X_MC;
    const auto X_CF =
        child.name == "model" ? FrameIn(child, name.substr(colons + 2), depth + 1) : std::nullopt;
    if (!X_CF) return std::nullopt;
    return X_MC * *X_CF;
  }
  return std::nullopt;
}

void WritePose(const Pose& X, XmlNode& pose) {
  pose.Remove("degrees");
  pose.Set("rotation_format", "quat_xyzw");
  pose.text.clear();
  for (const double value : {X.p.x(), X.p.y(), X.p.z(), X.q.x(), X.q.y(), X.q.z(), X.q.w()})
    pose.text += (pose.text.empty() ? "" : " ") + FormatNumber(value);
}

}  // namespace

Pose PoseOf(const XmlNode* pose) {
  std::vector<double> p;
  for (const std::string& word : SplitWords(pose == nullptr ? "" : pose->text))
    p.push_back(ParsePlain(word).value_or(0));
  p.resize(7);
  if (pose != nullptr && pose->Attribute("rotation_format") == "quat_xyzw") {
    const Quaternion q(p[6], p[3], p[4], p[5]);
    return {{p[0], p[1], p[2]}, q.norm() > 1e-6 ? q.normalized() : Quaternion::Identity()};
  }
  const std::string degrees = pose == nullptr ? "" : pose->Attribute("degrees");
  const double unit = degrees == "true" || degrees == "1" ? std::numbers::pi / 180 : 1;
  return {{p[0], p[1], p[2]}, FromRollPitchYaw(unit * p[3], unit * p[4], unit * p[5])};
}

void SettlePlacement(XmlNode& model, Diagnostics& diagnostics) {
  const std::string name = model.Attribute("placement_frame");
  model.Remove("placement_frame");
  const auto X_MF = FrameIn(model, name);
  if (!X_MF) {
    diagnostics.Warning(model.where, "placement_frame '" + Printable(name) + "' names nothing in model '" +
                                         Printable(model.Attribute("name")) +
                                         "': <pose> places the model's own frame");
    return;
  }
  if (name.empty()) return;
  XmlNode& pose = model.Child("pose") == nullptr ? model.Add("pose") : *model.Child("pose");
  WritePose(PoseOf(&pose) * X_MF->Inverse(), pose);
}

}  // namespace coopdyn
