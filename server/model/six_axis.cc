// SPDX-License-Identifier: MIT
// Rewrites joints with several axes, <coopdyn:six_axis> and SDF's revolute2, as chains of joints with one
// axis each.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "server/base/words.h"
#include "server/model/model_source.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// One axis of a chain.
struct ChainPart {
  std::string name;  // of its joint
  std::string type;
  std::vector<XmlNode> elements;  // of its joint: <axis>, <sensor>
};

XmlNode NodeAt(const XmlNode& at, std::string name, std::string text = {}) {
  XmlNode node;
  node.name = std::move(name);
  node.text = std::move(text);
  node.where = at.where;
  return node;
}

/// The number in the element at `path`; nullopt unless it is above 0.
std::optional<double> ValueAt(const XmlNode& link, std::initializer_list<const char*> path) {
  const XmlNode* node = &link;
  for (const char* name : path) {
    node = node->Child(name);
    if (node == nullptr) return std::nullopt;
  }
  const auto value = ParsePlain(node->text);
  return value && *value > 0 ? value : std::nullopt;
}

class ChainWriter {
 public:
  ChainWriter(XmlNode& model, Diagnostics& diagnostics) : model_(model), diagnostics_(diagnostics) {}

  void Expand() {
    // Insert generated parts at the end: the list of the model's parts must not change before.
    for (XmlNode& child : model_.children) {
      if (child.name == "coopdyn:six_axis") ExpandSixAxis(child);
      if (child.name == "joint" && child.Attribute("type") == "revolute2") ExpandRevolute2(child);
    }
    std::vector<XmlNode> all;
    for (XmlNode& child : model_.children) {
      if (child.name == "link") {
        // Before the link that they carry, so that the last link of a chain stays last.
        for (auto& [link, carrier] : carriers_) {
          if (link == child.Attribute("name")) all.push_back(std::move(carrier));
        }
      }
      if (child.name != "coopdyn:expanded") all.push_back(std::move(child));
    }
    std::ranges::move(joints_, std::back_inserter(all));
    model_.children = std::move(all);
    for (XmlNode& child : model_.children) {
      if (child.name == "model") ChainWriter(child, diagnostics_).Expand();
    }
  }

 private:
  static constexpr std::array<const char*, 6> kAxes = {"x", "y", "z", "rx", "ry", "rz"};

  void Error(const XmlNode& at, std::string text) { diagnostics_.Error(at.where, std::move(text)); }

  const XmlNode* FindLink(const std::string& name) const {
    for (const XmlNode& child : model_.children) {
      if (child.name == "link" && child.Attribute("name") == name) return &child;
    }
    return nullptr;
  }

  /// Reports attributes that are not among `known`.
  void CheckWords(const XmlNode& node, const std::vector<std::string>& known) {
    for (const auto& [key, value] : node.attributes) {
      if (std::ranges::find(known, key) == known.end())
        Error(node, "<" + node.name + ">: unknown attribute '" + key + "'" + DidYouMean(key, known));
    }
  }

  /// A link between two axes. It weighs a millionth of the link that it carries, which has no effect because
  /// joints are solved in their own coordinates.
  XmlNode CarrierOf(const XmlNode& link, const std::string& name, const XmlNode& pose) const {
    constexpr double kShare = 1e-6, kUsual_kg = 0.1, kRadius2_m2 = 1e-4;
    const double mass_kg = kShare * ValueAt(link, {"inertial", "mass"}).value_or(kUsual_kg);
    double inertia = 0;
    for (const char* key : {"ixx", "iyy", "izz"}) {
      const auto value = ValueAt(link, {"inertial", "inertia", key});
      if (value) inertia = inertia == 0 ? kShare * *value : std::min(inertia, kShare * *value);
    }
    if (inertia == 0) inertia = mass_kg * kRadius2_m2;
    XmlNode carrier = NodeAt(pose, "link");
    carrier.Set("name", name);
    carrier.Set("coopdyn:carrier", "true");
    carrier.children.push_back(pose);
    XmlNode& inertial = carrier.Add("inertial");
    inertial.Add("mass", FormatNumber(mass_kg));
    XmlNode& moments = inertial.Add("inertia");
    for (const char* key : {"ixx", "iyy", "izz"}) moments.Add(key, FormatNumber(inertia));
    return carrier;
  }

  /// `pose`: common pose of all axes.
  void WriteChain(const XmlNode& at, const std::string& parent, const XmlNode& link, const XmlNode& pose,
                  std::vector<ChainPart> parts) {
    const std::string child = link.Attribute("name");
    std::string from = parent;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const bool is_last = i + 1 == parts.size();
      const std::string to = is_last ? child : parts[i].name + "_carrier";
      XmlNode joint = NodeAt(at, "joint");
      joint.Set("name", parts[i].name);
      joint.Set("type", parts[i].type);
      if (is_last) {
        joint.children.push_back(pose);
      } else {
        carriers_.emplace_back(child, CarrierOf(link, to, pose));
      }
      joint.Add("parent", from);
      joint.Add("child", to);
      std::ranges::move(parts[i].elements, std::back_inserter(joint.children));
      joints_.push_back(std::move(joint));
      from = to;
    }
  }

  /// The `<axis>` along `direction` with the attributes of `given`.
  XmlNode AxisOf(const XmlNode& given, const std::string& direction) {
    static const std::vector<std::string> kKnown = {"name",       "xyz",         "lower",   "upper",
                                                    "stiffness",  "rest",        "damping", "friction",
                                                    "max_effort", "max_velocity"};
    CheckWords(given, kKnown);
    for (const std::string& key : kKnown) {
      if (key != "name" && key != "xyz" && given.Has(key) && !ParsePlain(given.Attribute(key)))
        Error(given,
              "<coopdyn:axis>: '" + key + "' must be a finite number, not '" + given.Attribute(key) + "'");
    }
    if (given.Has("max_effort") != given.Has("max_velocity"))
      Error(given, "<coopdyn:axis>: a motor needs both max_effort and max_velocity");
    XmlNode axis = NodeAt(given, "axis");
    axis.Add("xyz", direction);
    const auto add = [&](const char* element,
                         std::initializer_list<std::pair<const char*, const char*>> words) {
      XmlNode made = NodeAt(given, element);
      for (const auto& [key, word] : words) {
        if (given.Has(key)) made.Add(word, given.Attribute(key));
      }
      if (!made.children.empty()) axis.children.push_back(std::move(made));
    };
    add("limit",
        {{"lower", "lower"}, {"upper", "upper"}, {"max_effort", "effort"}, {"max_velocity", "velocity"}});
    add("dynamics", {{"damping", "damping"},
                     {"friction", "friction"},
                     {"rest", "spring_reference"},
                     {"stiffness", "spring_stiffness"}});
    return axis;
  }

  void ExpandSixAxis(XmlNode& node) {
    XmlNode given = std::exchange(node, NodeAt(node, "coopdyn:expanded"));
    CheckWords(given, {"name", "parent", "child", "pose", "relative_to"});
    const std::string name = given.Attribute("name"), parent = given.Attribute("parent"),
                      child = given.Attribute("child");
    for (const char* key : {"name", "parent", "child"}) {
      if (given.Attribute(key).empty())
        Error(given, std::string("<coopdyn:six_axis>: the attribute '") + key + "' is missing");
    }
    std::vector<const XmlNode*> axes;
    for (const XmlNode& one : given.children) {
      const std::string axis = one.Attribute("name");
      if (one.name != "coopdyn:axis") {
        Error(one, "unknown element <" + one.name + "> in <coopdyn:six_axis>: it has <coopdyn:axis>");
      } else if (std::ranges::find(kAxes, axis) == kAxes.end()) {
        Error(one, "<coopdyn:axis>: name is x, y, z, rx, ry or rz, not '" + axis + "'");
      } else if (std::ranges::any_of(axes,
                                     [&](const auto* other) { return other->Attribute("name") == axis; })) {
        Error(one, "<coopdyn:axis>: there are two axes '" + axis + "' in '" + name + "': keep one");
      } else {
        axes.push_back(&one);
      }
    }
    const XmlNode* const link = FindLink(child);
    if (link == nullptr && !child.empty()) Error(given, NoLink("child", child, name));
    if (parent != "world" && !parent.empty() && FindLink(parent) == nullptr)
      Error(given, NoLink("parent", parent, name));
    if (link == nullptr) return;
    XmlNode pose = NodeAt(given, "pose", given.Has("pose") ? given.Attribute("pose") : "0 0 0 0 0 0");
    pose.Set("relative_to", given.Has("relative_to") ? given.Attribute("relative_to") : child);
    WriteChain(given, parent, *link, pose, PartsOf(name, axes));
  }

  std::string NoLink(const std::string& key, const std::string& link, const std::string& joint) const {
    std::vector<std::string> names;
    for (const XmlNode& child : model_.children) {
      if (child.name == "link") names.push_back(child.Attribute("name"));
    }
    return key + "=\"" + link + "\" of '" + joint + "' names no link of this model" + DidYouMean(link, names);
  }

  std::vector<ChainPart> PartsOf(const std::string& name, const std::vector<const XmlNode*>& axes) {
    if (axes.empty()) return {{name, "fixed", {}}};
    const auto turns = [](const XmlNode& axis) { return axis.Attribute("name").size() == 2; };
    const auto is_free = [&](const XmlNode* axis) { return turns(*axis) && axis->attributes.size() == 1; };
    std::vector<ChainPart> parts;
    const XmlNode* middle = nullptr;  // the second of three rotations
    for (std::size_t i = 0, turn = 0; i < axes.size(); ++i) {
      if (i + 3 <= axes.size() && std::all_of(axes.begin() + static_cast<std::ptrdiff_t>(i),
                                              axes.begin() + static_cast<std::ptrdiff_t>(i) + 3, is_free)) {
        parts.push_back({name + ".r", "ball", {}});
        i += 2;
        continue;
      }
      const XmlNode& axis = *axes[i];
      if (turns(axis) && ++turn == 2) middle = &axis;
      if (turns(axis) && turn == 3 && !middle->Has("stiffness") && !middle->Has("lower"))
        diagnostics_.Warning(
            middle->where, "'" + name + "." + middle->Attribute("name") +
                               "' is the second of three turns: near 90 degrees the first and the third are "
                               "one, so give it stops or a spring that keep it below 80");
      parts.push_back({name + "." + axis.Attribute("name"),
                       turns(axis) ? "revolute" : "prismatic",
                       {AxisOf(axis, DirectionOf(axis))}});
    }
    return parts;
  }

  static std::string DirectionOf(const XmlNode& axis) {
    const char name = axis.Attribute("name").back();
    return axis.Has("xyz") ? axis.Attribute("xyz") : name == 'x' ? "1 0 0" : name == 'y' ? "0 1 0" : "0 0 1";
  }

  /// Expands a revolute2, whose first axis is fixed to the parent and whose second axis to the child. With a
  /// <coopdyn:suspension> the child also slides along the first axis.
  void ExpandRevolute2(XmlNode& node) {
    const XmlNode* const link = FindLink(node.TextOf("child"));
    const XmlNode *const first = node.Child("axis"), *const second = node.Child("axis2");
    if (link == nullptr || first == nullptr || second == nullptr) return;  // reported when joints are read
    const XmlNode given = std::exchange(node, NodeAt(node, "coopdyn:expanded"));
    const std::string name = given.Attribute("name");
    XmlNode pose = NodeAt(given, "pose", "0 0 0 0 0 0");
    if (const XmlNode* own = given.Child("pose")) pose = *own;
    if (!pose.Has("relative_to")) pose.Set("relative_to", link->Attribute("name"));
    std::vector<ChainPart> parts;
    if (const XmlNode* suspension = given.Child("coopdyn:suspension")) {
      XmlNode axis = AxisOf(*suspension, "0 0 1");
      for (XmlNode& one : axis.children) {
        if (one.name == "xyz" && given.Child("axis")->Child("xyz") != nullptr)
          one = *given.Child("axis")->Child("xyz");
      }
      parts.push_back({name + ".suspension", "prismatic", {std::move(axis)}});
    }
    parts.push_back({name + ".axis1", "revolute", {*given.Child("axis")}});
    XmlNode second_axis = *given.Child("axis2");
    second_axis.name = "axis";
    parts.push_back({name + ".axis2", "revolute", {std::move(second_axis)}});
    for (const XmlNode& one : given.children) {
      static const std::vector<std::string> kDone = {"pose", "parent", "child",
                                                     "axis", "axis2",  "coopdyn:suspension"};
      if (std::ranges::find(kDone, one.name) == kDone.end()) parts.back().elements.push_back(one);
    }
    WriteChain(given, given.TextOf("parent"), *link, pose, std::move(parts));
  }

  XmlNode& model_;
  Diagnostics& diagnostics_;
  std::vector<std::pair<std::string, XmlNode>> carriers_;  // each with the name of the link that it carries
  std::vector<XmlNode> joints_;
};

}  // namespace

bool HasChains(const XmlNode& node) {
  return node.name == "coopdyn:six_axis" || (node.name == "joint" && node.Attribute("type") == "revolute2") ||
         std::ranges::any_of(node.children, HasChains);
}

void ExpandChains(XmlNode& model, Diagnostics& diagnostics) {
  if (HasChains(model)) ChainWriter(model, diagnostics).Expand();
}

}  // namespace coopdyn
