// SPDX-License-Identifier: MIT
// Splits models of a world whose links joints do not connect: each body becomes a separate model.
#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "server/model/model_source.h"

namespace coopdyn {

namespace {

bool IsNamedPart(const XmlNode& node) {
  return node.name == "link" || node.name == "joint" || node.name == "frame" || node.name == "model";
}

/// Groups parts of a model that are connected by references.
class Grouper {
 public:
  explicit Grouper(const XmlNode& model) : model_(model), groups_(model.children.size()) {
    std::iota(groups_.begin(), groups_.end(), std::size_t{0});
    for (std::size_t i = 0; i < model.children.size(); ++i) {
      if (IsNamedPart(model.children[i])) parts_.emplace(model.children[i].Attribute("name"), i);
    }
    for (std::size_t i = 0; i < model.children.size(); ++i) {
      if (IsNamedPart(model.children[i])) JoinAll(model.children[i], i);
    }
    for (std::size_t i = 0; i < groups_.size(); ++i) groups_[i] = RootOf(i);
  }

  /// The groups with a link or a model, that with the most joints first.
  std::vector<std::size_t> Bodies() const {
    std::vector<std::size_t> bodies;
    std::set<std::size_t> known;
    std::map<std::size_t, int> joints;
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const std::string& name = model_.children[i].name;
      if (name == "joint") ++joints[groups_[i]];
      if ((name == "link" || name == "model") && known.insert(groups_[i]).second)
        bodies.push_back(groups_[i]);
    }
    std::ranges::stable_sort(bodies, std::greater(), [&](std::size_t group) { return joints[group]; });
    return bodies;
  }
  std::size_t GroupOf(std::size_t child) const { return groups_[child]; }

 private:
  void Join(const std::string& name, std::size_t to) {
    if (name == "world") parts_.emplace(name, to);  // all parts fixed to the world are one body
    const auto found = parts_.find(name.substr(0, name.find("::")));
    if (found == parts_.end()) return;
    groups_[RootOf(found->second)] = RootOf(to);
  }
  std::size_t RootOf(std::size_t part) {
    while (groups_[part] != part) part = groups_[part] = groups_[groups_[part]];
    return part;
  }

  void JoinAll(const XmlNode& node, std::size_t part) {
    for (const char* key : {"relative_to", "attached_to", "expressed_in"}) Join(node.Attribute(key), part);
    for (const XmlNode& child : node.children) {
      if (child.name == "parent" || child.name == "child" || child.name == "gearbox_reference_body")
        Join(child.text, part);
      if (child.name == "mimic") Join(child.Attribute("joint"), part);
      if (child.name != "link" && child.name != "joint") JoinAll(child, part);
    }
  }

  const XmlNode& model_;
  std::map<std::string, std::size_t> parts_;
  std::vector<std::size_t> groups_;  // union-find over children; finally each child's representative
};

}  // namespace

std::vector<XmlNode> SplitLoose(const XmlNode& model) {
  const std::string fixed = model.TextOf("static");
  if (fixed == "1" || fixed == "true") return {model};
  const Grouper grouper(model);
  const std::vector<std::size_t> bodies = grouper.Bodies();
  if (bodies.size() <= 1) return {model};
  std::vector<XmlNode> models(bodies.size());
  const XmlNode* const pose = model.Child("pose");
  std::map<std::size_t, std::size_t> places;  // by group
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    places[bodies[i]] = i;
    models[i].name = model.name;
    models[i].where = model.where;
    models[i].attributes = model.attributes;
    if (pose != nullptr) models[i].children.push_back(*pose);
  }
  for (std::size_t i = 0; i < model.children.size(); ++i) {
    const XmlNode& child = model.children[i];
    if (child.name == "pose") continue;
    // Children that are not parts, or belong to no body, go to the first body.
    const auto place = IsNamedPart(child) ? places.find(grouper.GroupOf(i)) : places.end();
    XmlNode& one = models[place == places.end() ? 0 : place->second];
    const bool names = child.name == "link" || child.name == "model";
    if (names && &one != models.data() && one.Attribute("name") == model.Attribute("name"))
      one.Set("name", model.Attribute("name") + "_" + child.Attribute("name"));
    one.children.push_back(child);
  }
  for (XmlNode& one : models) {
    const std::string first = one.Attribute("canonical_link");
    const bool has = std::ranges::any_of(one.children, [&](const XmlNode& part) {
      return IsNamedPart(part) && part.Attribute("name") == first.substr(0, first.find("::"));
    });
    if (!has) one.Remove("canonical_link");
  }
  return models;
}

}  // namespace coopdyn
