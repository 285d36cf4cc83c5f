// SPDX-License-Identifier: MIT
// Handles <include merge="true">, which makes the parts of a model parts of the including model, and joints
// of an included model that name links of the enclosing model.
#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "server/model/model_source.h"

namespace coopdyn {

namespace {

constexpr const char* kModelFrame = "__model__";

/// Replaces references in `node` to the included model's frame by `frame`.
void NameFrame(XmlNode& node, const std::string& frame) {
  for (const char* key : {"relative_to", "expressed_in", "attached_to"}) {
    if (node.Attribute(key) == kModelFrame) node.Set(key, frame);
  }
  if ((node.name == "parent" || node.name == "child") && node.text == kModelFrame) node.text = frame;
  if (node.name == "model") return;  // a nested model has its own frame
  for (XmlNode& child : node.children) NameFrame(child, frame);
}

bool HasPart(const XmlNode& model, const std::string& name) {
  return std::ranges::any_of(model.children, [&](const XmlNode& one) {
    return (one.name == "link" || one.name == "frame" || one.name == "model") &&
           one.Attribute("name") == name;
  });
}

bool HasJoint(const XmlNode& model, const std::string& name) {
  return std::ranges::any_of(model.children, [&](const XmlNode& one) {
    return one.name == "joint" && one.Attribute("name") == name;
  });
}

/// Prefixes references in `node` to frames of `model` with the model's name.
void NameFramesOf(const XmlNode& model, XmlNode& node) {
  for (const char* key : {"relative_to", "expressed_in"}) {
    const std::string frame = node.Attribute(key);
    if (HasPart(model, frame)) node.Set(key, model.Attribute("name") + "::" + frame);
  }
  for (XmlNode& child : node.children) NameFramesOf(model, child);
}

}  // namespace

void RaiseJoints(XmlNode& model, Diagnostics& diagnostics) {
  std::vector<XmlNode> raised;
  for (XmlNode& inner : model.children) {
    if (inner.name != "model") continue;
    const auto is_outer = [&](const XmlNode& part) {
      return (part.name == "parent" || part.name == "child") && !HasPart(inner, part.text) &&
             HasPart(model, part.text) && part.text != inner.Attribute("name");
    };
    const std::string name = inner.Attribute("name");
    for (XmlNode& part : inner.children) {
      if (part.name != "joint" || std::ranges::none_of(part.children, is_outer)) continue;
      XmlNode joint = part;
      for (XmlNode& end : joint.children) {
        const bool is_inner = (end.name == "parent" || end.name == "child") && HasPart(inner, end.text);
        if (is_inner) end.text = name + "::" + end.text;
      }
      NameFramesOf(inner, joint);
      NameFrame(joint, name);
      const std::string given = joint.Attribute("name");
      const bool is_taken = HasJoint(model, given) || std::ranges::any_of(raised, [&](const XmlNode& one) {
                              return one.Attribute("name") == given;
                            });
      if (is_taken) joint.Set("name", name + "_" + given);
      diagnostics.Mended(joint.where, "joint '" + given + "' of model '" + name +
                                          "' names a link of the model around it: it is a joint of that one" +
                                          (is_taken ? ", called '" + name + "_" + given + "'" : ""));
      raised.push_back(std::move(joint));
      part.name.clear();
    }
    std::erase_if(inner.children, [](const XmlNode& part) { return part.name.empty(); });
  }
  std::ranges::move(raised, std::back_inserter(model.children));
}

std::vector<XmlNode> PartsToMerge(XmlNode model) {
  std::vector<XmlNode> parts;
  const XmlNode* pose = model.Child("pose");
  if (pose != nullptr) {
    // As libsdformat does: attach the parts to a frame at the model's pose.
    XmlNode frame;
    frame.name = "frame";
    frame.where = pose->where;
    const std::string name = "_merged__" + model.Attribute("name");
    frame.Set("name", name);
    const XmlNode* link = model.Child("link");
    if (link != nullptr) frame.Set("attached_to", link->Attribute("name"));
    frame.children.push_back(*pose);
    if (!pose->Has("relative_to")) frame.children.back().Set("relative_to", kModelFrame);
    for (XmlNode& part : model.children) {
      NameFrame(part, name);
      if (part.name == "frame" && !part.Has("attached_to")) part.Set("attached_to", name);
      if (part.name != "link" && part.name != "model") continue;
      if (part.Child("pose") == nullptr) part.Add("pose", "0 0 0 0 0 0");
      XmlNode& own = *part.Child("pose");
      if (!own.Has("relative_to")) own.Set("relative_to", name);
    }
    parts.push_back(std::move(frame));
  }
  for (XmlNode& part : model.children) {
    if (part.name != "pose" && part.name != "static") parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace coopdyn
