// SPDX-License-Identifier: MIT
// Fixes and checks names that older SDF and other programs allow but libsdformat does not.
#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <vector>

#include "server/model/model_source.h"
#include "server/model/values.h"

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

/// Removes the link `world`: the world itself holds everything attached to it.
void DropWorld(XmlNode& model, Diagnostics& diagnostics) {
  std::erase_if(model.children, [&](const XmlNode& one) {
    if (one.name != "link" || one.Attribute("name") != "world") return false;
    if (!one.children.empty()) {
      diagnostics.Mended(
          one.where, "the link 'world' is the world itself: what it has is left out; give it another name");
    }
    return true;
  });
}

/// True if the direction of an <axis> is 0 0 0.
bool IsZero(const XmlNode& axis) {
  const std::vector<std::string> xyz = SplitWords(axis.TextOf("xyz"));
  return xyz.size() == 3 && std::ranges::all_of(xyz, [](const auto& x) { return ParsePlain(x) == 0; });
}

/// Renames collisions and visuals with the same name.
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

void CheckJoint(const XmlNode& joint, const std::set<std::string>& names, Diagnostics& diagnostics) {
  static constexpr const char* kTypes[] = {"ball",     "continuous", "fixed", "gearbox",  "prismatic",
                                           "revolute", "revolute2",  "screw", "universal"};
  const std::string what =
      "joint '" + (joint.Has("coopdyn:name") ? joint.Attribute("coopdyn:name") : joint.Attribute("name")) +
      "'";
  const std::string type = joint.Attribute("type");
  if (std::ranges::find(kTypes, type) == std::end(kTypes)) {
    const std::vector<std::string> types(std::begin(kTypes), std::end(kTypes));
    diagnostics.Error(joint.where,
                      what + " cannot be of type '" + type + "': write one of " + JoinNames(types));
  }
  for (const char* end : {"parent", "child"}) {
    const XmlNode* node = joint.Child(end);
    const std::string name = node == nullptr ? "" : node->text;
    // Leave parts of nested models and SDF's reserved names to libsdformat.
    if (name.find("::") != std::string::npos || name.starts_with("__") || names.contains(name)) continue;
    if (name == "world" && node->name == "parent") continue;
    diagnostics.Error(
        node == nullptr ? joint.where : node->where,
        name.empty() ? what + " needs <" + end + "> with the name of a link"
                     : "<" + std::string(end) + "> of " + what + " names no link of this model: '" + name +
                           "'" + DidYouMean(name, std::vector<std::string>(names.begin(), names.end())));
  }
  if (const std::string child = joint.TextOf("child"); !child.empty() && child == joint.TextOf("parent"))
    diagnostics.Error(joint.where, what + " joins link '" + child + "' to itself: name two links");
  const XmlNode* axis = joint.Child("axis");
  if (axis != nullptr && IsZero(*axis))
    diagnostics.Error(axis->where,
                      "the <xyz> of " + what + " is the direction of its axis: it cannot be 0 0 0");
}

}  // namespace

void FixStillJoints(XmlNode& model, Diagnostics& diagnostics) {
  for (XmlNode& child : model.children) {
    if (child.name == "model") FixStillJoints(child, diagnostics);
    const XmlNode* axis = child.name == "joint" ? child.Child("axis") : nullptr;
    const XmlNode* limit = axis == nullptr ? nullptr : axis->Child("limit");
    if (limit == nullptr || !IsZero(*axis) || ParsePlain(limit->TextOf("lower")) != 0 ||
        ParsePlain(limit->TextOf("upper")) != 0)
      continue;
    diagnostics.Mended(axis->where, "joint '" + child.Attribute("name") +
                                        "' has no direction and no way to go: it is taken as fixed");
    child.Set("type", "fixed");
    std::erase_if(child.children, [](const XmlNode& one) { return one.name == "axis"; });
  }
}

void CheckCanonicalLink(XmlNode& model, bool is_strict, Diagnostics& diagnostics) {
  for (XmlNode& child : model.children) {
    if (child.name == "model") CheckCanonicalLink(child, is_strict, diagnostics);
  }
  std::string rest = model.Attribute("canonical_link");
  const XmlNode* found = &model;
  while (found != nullptr && !rest.empty()) {
    const std::size_t colons = rest.find("::");
    const std::string name = rest.substr(0, colons), kind = colons == std::string::npos ? "link" : "model";
    const auto next = std::ranges::find_if(found->children, [&](const XmlNode& child) {
      return child.name == kind && child.Attribute("name") == name;
    });
    found = next == found->children.end() ? nullptr : &*next;
    rest = colons == std::string::npos ? "" : rest.substr(colons + 2);
  }
  if (found != nullptr) return;
  const std::string what = "canonical_link of model '" + model.Attribute("name") +
                           "' names no link of it: '" + model.Attribute("canonical_link") + "'";
  model.Remove("canonical_link");
  if (is_strict)
    diagnostics.Error(model.where, what);
  else
    diagnostics.Mended(model.where, what + ": its first link is taken (--strict makes this an error)");
}

void CheckNames(const XmlNode& model, Diagnostics& diagnostics) {
  std::set<std::string> names, joints;
  for (const XmlNode& child : model.children) {
    const bool is_joint = child.name == "joint";
    if (!is_joint && !IsPart(child)) continue;
    const std::string name = child.Attribute("name");
    if (!name.empty() && !(is_joint ? joints : names).insert(name).second)
      diagnostics.Error(child.where,
                        "there are two called '" + name + "': give this <" + child.name + "> another name");
  }
  for (const XmlNode& child : model.children) {
    if (child.name == "joint") CheckJoint(child, names, diagnostics);
    if (child.name == "model") CheckNames(child, diagnostics);
  }
}

void NumberSensors(XmlNode& model, Diagnostics& diagnostics) {
  for (XmlNode& part : model.children) {
    if (part.name == "model") NumberSensors(part, diagnostics);
    if (part.name != "link" && part.name != "joint") continue;
    std::set<std::string> given, taken;
    std::map<std::string, int> numbers;
    for (const XmlNode& child : part.children) {
      if (child.name == "sensor") given.insert(child.Attribute("name"));
    }
    for (XmlNode& child : part.children) {
      const std::string name = child.Attribute("name");
      if (child.name != "sensor" || name.empty() || taken.insert(name).second) continue;
      int& number = numbers.emplace(name, 2).first->second;
      while (given.contains(name + "_" + std::to_string(number))) ++number;
      child.Set("name", name + "_" + std::to_string(number));
      given.insert(child.Attribute("name"));
      diagnostics.Mended(child.where, "another <sensor> here is called '" + name + "': this one is called '" +
                                          child.Attribute("name") + "'");
    }
  }
}

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
    // Everything but libsdformat uses the original name.
    child.Set("coopdyn:name", name);
    std::string other = FreeName(name.empty() ? "joint" : name, taken);
    while (joints.contains(other)) other = FreeName(other, taken);
    child.Set("name", other);
    taken.insert(std::move(other));
  }
}

}  // namespace coopdyn
