// SPDX-License-Identifier: MIT
// Names that older SDF and other programs allow and libsdformat does not.
#include <algorithm>
#include <set>

#include "server/model/model_source.h"

namespace coopdyn {

namespace {

bool IsReserved(const std::string& name) {
  return name.empty() || name == "world" ||
         (name.size() > 4 && name.starts_with("__") && name.ends_with("__"));
}

std::string FreeName(std::string name, const std::set<std::string>& taken) {
  do {
    name += "_";
  } while (taken.contains(name));
  return name;
}

bool IsPart(const XmlNode& node) {
  return node.name == "link" || node.name == "frame" || node.name == "model";
}

/// The link `world` is the world, which holds what hangs on it.
void DropWorld(XmlNode& model, Diagnostics& diagnostics) {
  std::erase_if(model.children, [&](const XmlNode& one) {
    if (one.name != "link" || one.Attribute("name") != "world") return false;
    if (!one.children.empty()) {
      diagnostics.Warning(
          one.where, "the link 'world' is the world itself: what it has is left out; give it another name");
    }
    return true;
  });
}

/// Collisions and visuals that have the same name.
void NumberShapes(XmlNode& link) {
  for (const char* kind : {"collision", "visual"}) {
    std::set<std::string> taken;
    for (XmlNode& shape : link.children) {
      if (shape.name != kind) continue;
      std::string name = shape.Attribute("name");
      if (taken.contains(name) || IsReserved(name)) name = FreeName(name.empty() ? kind : name, taken);
      if (shape.Has("name")) shape.Set("name", name);
      taken.insert(std::move(name));
    }
  }
}

}  // namespace

void FreeNames(XmlNode& model, Diagnostics& diagnostics) {
  DropWorld(model, diagnostics);
  std::set<std::string> taken;
  for (const XmlNode& child : model.children) {
    if (IsPart(child)) taken.insert(child.Attribute("name"));
  }
  std::set<std::string> joints;
  for (const XmlNode& child : model.children) {
    if (child.name == "joint") joints.insert(child.Attribute("name"));
  }
  for (XmlNode& child : model.children) {
    if (child.name == "link") NumberShapes(child);
    if (child.name == "model") FreeNames(child, diagnostics);
    if (child.name == "frame" && child.Attribute("name") == "world") {
      diagnostics.Error(
          child.where, "a <frame> cannot be called 'world', which is the world itself: give it another name");
    }
    if (child.name != "joint" || !child.Has("name")) continue;
    const std::string name = child.Attribute("name");
    if (!taken.contains(name) && !IsReserved(name)) continue;
    // Everybody but libsdformat goes on calling it so.
    child.Set("coopdyn:name", name);
    std::string other = FreeName(name.empty() ? "joint" : name, taken);
    while (joints.contains(other)) other = FreeName(other, taken);
    child.Set("name", other);
    taken.insert(std::move(other));
  }
}

}  // namespace coopdyn
