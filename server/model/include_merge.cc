// SPDX-License-Identifier: MIT
// <include merge="true">: the parts of a model become parts of the one that includes it.
#include <utility>

#include "server/model/model_source.h"

namespace coopdyn {

namespace {

constexpr const char* kModelFrame = "__model__";

/// What names the included model's frame names `frame` instead.
void NameFrame(XmlNode& node, const std::string& frame) {
  for (const char* key : {"relative_to", "expressed_in", "attached_to"}) {
    if (node.Attribute(key) == kModelFrame) node.Set(key, frame);
  }
  if ((node.name == "parent" || node.name == "child") && node.text == kModelFrame) node.text = frame;
  if (node.name == "model") return;  // one inside has a frame of its own
  for (XmlNode& child : node.children) NameFrame(child, frame);
}

}  // namespace

std::vector<XmlNode> PartsToMerge(XmlNode model) {
  std::vector<XmlNode> parts;
  const XmlNode* pose = model.Child("pose");
  if (pose != nullptr) {
    // As libsdformat does it: a frame where the model would stand holds its parts.
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
