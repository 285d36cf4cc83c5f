// SPDX-License-Identifier: MIT
// Translates URDF into SDF element by element, so that messages have the lines of the URDF.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "server/model/model_source.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

class UrdfConverter {
 public:
  UrdfConverter(const XmlNode& robot, Diagnostics& diagnostics) : robot_(robot), diagnostics_(diagnostics) {}

  XmlNode Convert() {
    XmlNode sdf = At("sdf", robot_);
    sdf.Set("version", "1.9");
    XmlNode& model = sdf.children.emplace_back(At("model", robot_));
    model.Set("name", robot_.Attribute("name").empty() ? "robot" : robot_.Attribute("name"));
    for (const XmlNode& child : robot_.children) {
      if (child.name == "material") materials_[child.Attribute("name")] = &child;
      if (child.name == "link") links_.insert(child.Attribute("name"));
    }
    for (const XmlNode& child : robot_.children) {
      if (child.name == "joint") parents_[TextOfEnd(child, "child")] = &child;
      if (child.name == "gazebo") extras_[child.Attribute("reference")].push_back(&child);
    }
    RefuseLoops();
    // In SDF, links and joints share one namespace. The joint's original name is stored separately.
    for (const XmlNode& child : robot_.children) {
      if (child.name != "joint") continue;
      std::string id = child.Attribute("name");
      while (links_.contains(id) || id == "world") id += "_";
      ids_[&child] = id;
    }
    for (const XmlNode& child : robot_.children) {
      if (child.name == "joint") joints_.insert(child.Attribute("name"));
    }
    ReportExtras();
    // Many models have a link `world` to fix their base to the world.
    links_.erase("world");
    FindFreeRoots();
    if (!HasOwnElements(robot_)) sdf.Set("coopdyn:foreign", "true");
    for (const XmlNode& child : robot_.children) {
      if (child.name == "link" && IsWorld(child.Attribute("name"))) {
        if (!child.children.empty()) {
          Mended(child,
                 "the link 'world' is the world itself: what it has is left out; give it another name");
        }
      } else if (child.name == "link") {
        model.children.push_back(Link(child));
      } else if (child.name == "joint") {
        if (auto joint = Joint(child)) model.children.push_back(std::move(*joint));
      } else if (child.name == "gazebo") {
        if (!child.Has("reference")) {
          for (const XmlNode& inner : child.children) model.children.push_back(inner);
        }
      } else if (child.name == "transmission" || child.name == "ros2_control") {
        AddCommanded(child, model);
      } else if (child.name != "material") {
        diagnostics_.LeftOut(child.where, "<" + child.name + "> in <robot>");
      }
    }
    ReportSafety();
    return sdf;
  }

 private:
  static XmlNode At(std::string name, const XmlNode& where) {
    XmlNode node;
    node.name = std::move(name);
    node.where = where.where;
    return node;
  }
  void Mended(const XmlNode& at, std::string text) { diagnostics_.Mended(at.where, std::move(text)); }
  void Note(const XmlNode& at, std::string text) { diagnostics_.Note(at.where, std::move(text)); }
  void Error(const XmlNode& at, std::string text) { diagnostics_.Error(at.where, std::move(text)); }

  /// Reports loops of links: each link is placed by its parent joint.
  void RefuseLoops() {
    for (const auto& [link, joint] : parents_) {
      std::string above = TextOfEnd(*joint, "parent");
      for (std::size_t i = 0; i < parents_.size() && above != link; ++i) {
        const auto next = parents_.find(above);
        if (next == parents_.end()) break;
        above = TextOfEnd(*next->second, "parent");
      }
      if (above != link) continue;
      return Error(*joint,
                   "joint '" + joint->Attribute("name") + "': link '" + link +
                       "' hangs on itself by a loop of joints: remove one of them, or write the robot in "
                       "SDF, which has loops");
    }
  }

  /// Finds empty root links on which a robot floats: they represent the world.
  void FindFreeRoots() {
    for (const XmlNode& child : robot_.children) {
      const std::string name = child.Attribute("name");
      if (child.name != "link" || !child.children.empty() || parents_.contains(name)) continue;
      bool floats = false, holds = false;
      for (const auto& [link, joint] : parents_) {
        if (TextOfEnd(*joint, "parent") != name) continue;
        (IsDropped(*joint) ? floats : holds) = true;
      }
      if (!floats || holds) continue;
      free_roots_.insert(name);
      links_.erase(name);
    }
  }
  bool IsWorld(const std::string& link) const { return link == "world" || free_roots_.contains(link); }

  /// True for joint types that SDF lacks. The child then only gets the joint's pose in the parent.
  static bool IsDropped(const XmlNode& joint) {
    return joint.Attribute("type") == "floating" || joint.Attribute("type") == "planar";
  }

  /// Adds motors to joints that ROS controllers command. With several <ros2_control>, each becomes a group.
  void AddCommanded(const XmlNode& given, XmlNode& model) {
    std::string names;
    for (const XmlNode& child : given.children) {
      const std::string name = child.Attribute("name");
      const bool commanded = given.name == "transmission" || child.Child("command_interface") != nullptr;
      if (child.name != "joint" || !commanded || !joints_.contains(name)) continue;
      XmlNode& moved = model.children.emplace_back(At("coopdyn:gazebo_joint", child));
      moved.Set("joint", name);
      names += name + " ";
    }
    const auto controls = std::ranges::count(robot_.children, "ros2_control", &XmlNode::name);
    if (given.name == "transmission" || controls < 2 || names.empty()) return;
    XmlNode& group = model.children.emplace_back(At("coopdyn:gazebo_group", given));
    group.Set("name", given.Attribute("name"));
    group.Set("joints", names);
  }

  void ReportSafety() {
    for (const XmlNode& child : robot_.children) {
      const XmlNode* safety = child.name == "joint" ? child.Child("safety_controller") : nullptr;
      if (safety != nullptr)
        return Note(*safety, "<safety_controller> is not used by coopdyn: joints stop at their <limit>");
    }
  }

  static std::string TextOfEnd(const XmlNode& joint, const char* end) {
    const XmlNode* found = joint.Child(end);
    return found == nullptr ? "" : found->Attribute("link");
  }

  /// "x y z roll pitch yaw" of an <origin>.
  static std::string PoseOf(const XmlNode& element) {
    const XmlNode* origin = element.Child("origin");
    const auto part = [origin](const char* key) {
      const std::string text = origin == nullptr ? "" : origin->Attribute(key);
      return Trim(text).empty() ? std::string("0 0 0") : text;
    };
    return part("xyz") + " " + part("rpy");
  }

  XmlNode Link(const XmlNode& link) {
    XmlNode out = At("link", link);
    const std::string name = link.Attribute("name");
    out.Set("name", name);
    if (const auto parent = parents_.find(name); parent != parents_.end()) {
      // In URDF, a link's frame is that of its parent joint.
      XmlNode& pose = out.Add("pose", "0 0 0 0 0 0");
      const std::string above = TextOfEnd(*parent->second, "parent");
      if (IsDropped(*parent->second)) pose.text = PoseOf(*parent->second);
      if (!IsDropped(*parent->second)) {
        pose.Set("relative_to", ids_.at(parent->second));
      } else if (!IsWorld(above)) {
        pose.Set("relative_to", above);
      }
    }
    int shapes = 0;
    for (const XmlNode& child : link.children) {
      if (child.name == "inertial") {
        out.children.push_back(Inertial(child));
      } else if (child.name == "collision" || child.name == "visual") {
        XmlNode shape = At(child.name, child);
        shape.Set("name",
                  (child.Has("name") && !child.Attribute("name").empty() ? child.Attribute("name") + "_"
                                                                         : child.name + "_") +
                      std::to_string(++shapes));
        shape.Add("pose", PoseOf(child));
        if (const XmlNode* geometry = child.Child("geometry")) shape.children.push_back(Geometry(*geometry));
        if (child.name == "visual") AddMaterial(child, name, shape);
        if (child.name == "collision") AddSurface(name, shape);
        out.children.push_back(std::move(shape));
      } else {
        diagnostics_.LeftOut(child.where, "<" + child.name + "> in <link>");
      }
    }
    for (const XmlNode* extra : ExtrasOf(name)) {
      for (const XmlNode& inner : extra->children) {
        if (inner.name == "sensor") out.children.push_back(inner);
      }
    }
    return out;
  }

  static XmlNode Inertial(const XmlNode& inertial) {
    XmlNode out = At("inertial", inertial);
    out.Add("pose", PoseOf(inertial));
    if (const XmlNode* mass = inertial.Child("mass")) {
      out.Add("mass", mass->Attribute("value")).where = mass->where;
    }
    if (const XmlNode* inertia = inertial.Child("inertia")) {
      XmlNode& moments = out.children.emplace_back(At("inertia", *inertia));
      for (const auto& [key, value] : inertia->attributes) moments.Add(key, value);
    }
    return out;
  }

  XmlNode Geometry(const XmlNode& geometry) {
    XmlNode out = At("geometry", geometry);
    for (const XmlNode& shape : geometry.children) {
      XmlNode& made = out.children.emplace_back(At(shape.name, shape));
      if (shape.name == "mesh") {
        made.Add("uri", shape.Attribute("filename"));
        if (shape.Has("scale")) made.Add("scale", shape.Attribute("scale"));
        continue;
      }
      for (const auto& [key, value] : shape.attributes) made.Add(key, value);
    }
    return out;
  }

  std::vector<const XmlNode*> ExtrasOf(const std::string& reference) const {
    const auto found = extras_.find(reference);
    return found == extras_.end() ? std::vector<const XmlNode*>() : found->second;
  }

  /// True for the elements of a <gazebo reference="link"> that coopdyn uses.
  static bool IsUsedExtra(const XmlNode& inner) {
    if (inner.name == "material") return GazeboColor(inner.text).has_value();
    if (inner.name == "visual") return DiffuseOf(inner) != nullptr;
    if (inner.name == "sensor") return true;
    static constexpr std::array kWords = {"mu", "mu1", "mu2", "fdir1", "kp", "kd"};
    return std::ranges::find(kWords, inner.name) != kWords.end() && !ValueOf(inner).empty();
  }
  /// As in Gazebo: the attribute `value`, or else the text.
  static std::string ValueOf(const XmlNode& extra) {
    const std::string value = extra.Attribute("value");
    return value.empty() ? extra.text : value;
  }
  static const XmlNode* DiffuseOf(const XmlNode& visual) {
    const XmlNode* material = visual.Child("material");
    return material == nullptr ? nullptr : material->Child("diffuse");
  }

  /// Reports unused elements of <gazebo>, each kind once.
  void ReportExtras() {
    std::map<std::string, std::pair<const XmlNode*, int>> left_out;
    for (const auto& [reference, extras] : extras_) {
      if (reference.empty()) continue;  // belong to the model
      for (const XmlNode* extra : extras) {
        if (!links_.contains(reference) && !joints_.contains(reference)) {
          Note(*extra, "<gazebo reference=\"" + reference + "\"> names no link or joint of this robot");
          continue;
        }
        for (const XmlNode& inner : extra->children) {
          if (inner.name == "sensor" || (links_.contains(reference) && IsUsedExtra(inner))) continue;
          if (IsAsHere(inner)) continue;
          auto& [first, count] = left_out[inner.name];
          if (count++ == 0) first = &inner;
        }
      }
    }
    for (const auto& [name, entry] : left_out) {
      const auto& [first, count] = entry;
      diagnostics_.LeftOut(first->where, "<" + name + "> in <gazebo reference>", count);
    }
  }

  /// Adds the visual's colour. As in Gazebo, that of a <gazebo reference> has precedence over the material's.
  void AddMaterial(const XmlNode& visual, const std::string& link, XmlNode& out) {
    for (const XmlNode* extra : ExtrasOf(link)) {
      for (const XmlNode& inner : extra->children) {
        const auto color = inner.name == "material" ? GazeboColor(inner.text) : std::nullopt;
        const XmlNode* diffuse = inner.name == "visual" ? DiffuseOf(inner) : nullptr;
        if (!color && diffuse == nullptr) continue;
        out.children.emplace_back(At("material", inner)).Add("diffuse", color ? *color : diffuse->text);
        return;
      }
    }
    const XmlNode* material = visual.Child("material");
    if (material == nullptr) return;
    if (material->Child("color") == nullptr) {
      const auto shared = materials_.find(material->Attribute("name"));
      if (shared != materials_.end()) material = shared->second;
    }
    if (material->Child("texture") != nullptr)
      Note(*material, "<texture> is not drawn: write <color rgba=\"…\"/>");
    const XmlNode* color = material->Child("color");
    if (color == nullptr) return;
    XmlNode& made = out.children.emplace_back(At("material", *material));
    made.Add("diffuse", color->Attribute("rgba"));
  }

  /// The first <word> in a <gazebo reference="link">; null: none.
  const XmlNode* Extra(const std::string& link, const char* word) const {
    for (const XmlNode* extra : ExtrasOf(link)) {
      const XmlNode* found = extra->Child(word);
      if (found != nullptr && !ValueOf(*found).empty()) return found;
    }
    return nullptr;
  }

  /// Adds the friction and the stiffness of <gazebo reference="link"><mu1>…<kp>….
  void AddSurface(const std::string& link, XmlNode& collision) {
    const XmlNode* mu = Extra(link, "mu1");
    if (mu == nullptr) mu = Extra(link, "mu");
    const XmlNode *kp = Extra(link, "kp"), *kd = Extra(link, "kd");
    if (mu == nullptr && kp == nullptr && kd == nullptr) return;
    XmlNode& surface = collision.Add("surface");
    const auto add = [](XmlNode& to, const char* name, const XmlNode* from) {
      if (from != nullptr) to.Add(name, ValueOf(*from)).where = from->where;
    };
    if (mu != nullptr) {
      XmlNode& ode = surface.Add("friction").Add("ode");
      add(ode, "mu", mu);
      for (const char* word : {"mu2", "fdir1"}) add(ode, word, Extra(link, word));
    }
    if (kp == nullptr && kd == nullptr) return;
    XmlNode& ode = surface.Add("contact").Add("ode");
    add(ode, "kp", kp);
    add(ode, "kd", kd);
  }

  std::optional<XmlNode> Joint(const XmlNode& joint) {
    const std::string name = joint.Attribute("name");
    std::string type = joint.Attribute("type");
    if (type == "floating") {
      Mended(joint,
             "joint '" + name + "' of type floating is left out: a robot that is not fixed floats anyway");
      return std::nullopt;
    }
    if (type == "spherical") type = "ball";  // Bullet's name
    if (type == "planar") return Planar(joint);
    XmlNode out = At("joint", joint);
    out.Set("name", ids_.at(&joint));
    if (ids_.at(&joint) != name) out.Set("coopdyn:name", name);
    out.Set("type", type);
    const std::string parent = TextOfEnd(joint, "parent"), child = TextOfEnd(joint, "child");
    for (const auto& [end, link] : {std::pair("parent", parent), std::pair("child", child)}) {
      if (links_.contains(link) || (link == "world" && end[0] == 'p')) continue;
      Error(joint,
            "joint '" + name + "' needs <" + end + " link=\"…\"/> that names a link, not '" + link + "'");
    }
    // URDF gives a joint's frame relative to the parent's.
    out.Add("pose", PoseOf(joint)).Set("relative_to", parent == "world" ? "__model__" : parent);
    out.Add("parent", parent);
    out.Add("child", child);
    if (type != "fixed" && type != "ball") out.children.push_back(Axis(joint));
    if (const XmlNode* mimic = joint.Child("mimic")) out.children.push_back(Mimic(*mimic));
    for (const XmlNode* extra : ExtrasOf(name)) {
      if (links_.contains(name)) break;  // belong to the link of that name
      for (const XmlNode& inner : extra->children) {
        if (inner.name == "sensor") out.children.push_back(inner);
      }
    }
    return out;
  }

  /// Replaces a planar joint by two sliders in the plane and a hinge about its normal.
  XmlNode Planar(const XmlNode& joint) {
    const std::string name = joint.Attribute("name");
    Mended(joint, "joint '" + name + "' of type planar is three: '" + name + ".x', '" + name + ".y' and '" +
                      name + ".rz'");
    Vector3 normal = Vector3::UnitX();  // URDF's default
    const XmlNode* axis = joint.Child("axis");
    const std::vector<std::string> words = SplitWords(axis == nullptr ? "" : axis->Attribute("xyz"));
    for (std::size_t i = 0; i < 3 && words.size() == 3; ++i)
      normal[static_cast<Eigen::Index>(i)] = ParsePlain(words[i]).value_or(0);
    if (!(normal.norm() > 1e-9 && normal.norm() < 1e9)) {
      Error(joint, "the <axis> of joint '" + name + "' is the normal of its plane: write xyz=\"0 0 1\"");
      normal = Vector3::UnitZ();
    }
    normal.normalize();
    const Vector3 other = std::abs(normal.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
    const Vector3 along = (other - other.dot(normal) * normal).normalized();
    XmlNode out = At("coopdyn:six_axis", joint);
    out.Set("name", name);
    const std::string parent = TextOfEnd(joint, "parent");
    out.Set("parent", IsWorld(parent) ? "world" : parent);
    out.Set("child", TextOfEnd(joint, "child"));
    const XmlNode* limit = joint.Child("limit");
    const Vector3 across = normal.cross(along);
    for (const auto& [key, direction] : {std::pair("x", along), {"y", across}, {"rz", normal}}) {
      XmlNode& one = out.Add("coopdyn:axis");
      one.Set("name", key);
      one.Set("xyz", FormatNumber(direction.x()) + " " + FormatNumber(direction.y()) + " " +
                         FormatNumber(direction.z()));
      if (limit == nullptr || !limit->Has("effort") || !limit->Has("velocity")) continue;
      one.Set("max_effort", limit->Attribute("effort"));
      one.Set("max_velocity", limit->Attribute("velocity"));
    }
    return out;
  }

  static XmlNode Axis(const XmlNode& joint) {
    const XmlNode* axis = joint.Child("axis");
    XmlNode out = At("axis", axis == nullptr ? joint : *axis);
    out.Add("xyz", axis == nullptr || axis->Attribute("xyz").empty() ? "1 0 0" : axis->Attribute("xyz"));
    if (const XmlNode* limit = joint.Child("limit")) {
      XmlNode& made = out.children.emplace_back(At("limit", *limit));
      for (const auto& [key, value] : limit->attributes) {
        if (joint.Attribute("type") == "continuous" && (key == "lower" || key == "upper")) continue;
        made.Add(key, value);
      }
      // URDF's default limit is 0; SDF has no default limit.
      if (joint.Attribute("type") != "continuous") {
        for (const char* key : {"lower", "upper"}) {
          if (!limit->Has(key)) made.Add(key, "0");
        }
      }
    }
    if (const XmlNode* dynamics = joint.Child("dynamics")) {
      XmlNode& made = out.children.emplace_back(At("dynamics", *dynamics));
      for (const auto& [key, value] : dynamics->attributes) made.Add(key, value);
    }
    return out;
  }

  /// A <mimic> in the form of SDF 1.11.
  static XmlNode Mimic(const XmlNode& mimic) {
    XmlNode out = At("mimic", mimic);
    out.Set("joint", mimic.Attribute("joint"));
    for (const char* key : {"multiplier", "offset"}) {
      if (mimic.Has(key)) out.Add(key, mimic.Attribute(key));
    }
    return out;
  }

  const XmlNode& robot_;
  Diagnostics& diagnostics_;
  std::map<std::string, const XmlNode*> materials_;
  std::map<std::string, const XmlNode*> parents_;  // joints, by child link
  std::map<const XmlNode*, std::string> ids_;      // names of joints in the SDF
  std::map<std::string, std::vector<const XmlNode*>> extras_;
  std::set<std::string> links_, joints_;
  std::set<std::string> free_roots_;  // links that represent the world
};

}  // namespace

XmlNode SdfOfUrdf(const XmlNode& robot, Diagnostics& diagnostics) {
  return UrdfConverter(robot, diagnostics).Convert();
}

}  // namespace coopdyn
