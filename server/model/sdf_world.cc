// SPDX-License-Identifier: MIT
#include "server/model/sdf_world.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>

#include "server/base/portable_math.h"
#include "server/model/gazebo_plugins.h"
#include "server/model/mjcf.h"
#include "server/model/model_source.h"
#include "server/model/resources.h"
#include "server/model/sdf_body.h"
#include "server/model/text_file.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

std::string Exact(double value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof(text), value, std::chars_format::fixed, 12);
  if (end.ec != std::errc()) return FormatNumber(value);  // the scenario reader reports such a large number
  std::string out(text, end.ptr);
  out.erase(out.find_last_not_of('0') + 1);
  if (out.ends_with('.')) out.pop_back();
  return out == "-0" ? "0" : out;
}
std::string Exact(const Vector3& v) {
  return Exact(v.x()) + " " + Exact(v.y()) + " " + Exact(v.z());
}

/// True if an <inertial> in `node` says where the mass is.
bool PlacesMass(const XmlNode& node) {
  if (node.name == "inertial") return node.Child("inertia") != nullptr || node.Child("pose") != nullptr;
  return std::ranges::any_of(node.children, PlacesMass);
}

/// The mass of a link, compared with the uniform solid of its only shape.
struct MassPlace {
  bool is_centred = true;                   // centre of mass within 1 % of the size
  bool is_uniform = true;                   // moments within 5 %
  Vector3 moments_kg_m2 = Vector3::Zero();  // about the shape's axes
  Vector3 solid_kg_m2 = Vector3::Zero();
};
MassPlace CompareWithSolid(const LinkModel& link) {
  constexpr double kShift = 0.01, kMoments = 0.05;
  const LinkShape& only = link.collisions.front();
  const Pose X_GI = only.X_LG.Inverse() * link.X_LI;
  const Matrix3 R_GI = X_GI.q.toRotationMatrix();
  const Matrix3 inertia_kg_m2 = R_GI * link.inertia_kg_m2.asDiagonal() * R_GI.transpose();
  const Vector3 size_m = 2 * HalfExtents(only.shape, Quaternion::Identity());
  const Vector3 solid_kg_m2 = SolidInertia(only.shape, link.mass_kg);
  MassPlace place{true, true, inertia_kg_m2.diagonal(), solid_kg_m2};
  for (int i = 0; i < 3; ++i) {
    place.is_centred &= std::abs(X_GI.p[i]) <= kShift * size_m[i];
    for (int k = 0; k < 3; ++k) {
      const double solid = i == k ? solid_kg_m2[i] : 0;
      const double scale = std::sqrt(solid_kg_m2[i] * solid_kg_m2[k]);
      place.is_uniform &= std::abs(inertia_kg_m2(i, k) - solid) <= kMoments * scale;
    }
  }
  return place;
}

/// Roll, pitch and yaw about the fixed axes.
std::string Angles(const Quaternion& q) {
  return Exact(ToRollPitchYaw(q));
}

class WorldConverter {
 public:
  WorldConverter(std::filesystem::path file, Resources resources, Diagnostics& diagnostics)
      : file_(std::move(file)), resources_(std::move(resources)), diagnostics_(diagnostics) {}

  std::optional<SdfWorld> Convert(XmlNode root) {
    XmlNode* world = root.Child("world");
    // Several models in a file, or several loose bodies in a model, are a world, too.
    if (world == nullptr && IsOneRobot(root)) return OneRobot();
    if (world == nullptr && CountModels(root) > 0) world = &root;
    if (root.name != "sdf" || world == nullptr) {
      diagnostics_.Error(root.where, "an SDF world starts with <sdf version=\"1.9\"> and holds a <world>");
      return std::nullopt;
    }
    Upgrade(root, root.Attribute("version"));
    const bool names_ground = std::ranges::any_of(world->children, [](const XmlNode& child) {
      return ToLower(child.TextOf("uri")).find("ground") != std::string::npos;
    });
    ExpandIncludes(*world, &resources_, diagnostics_);
    ReadSimulation(*world);
    for (XmlNode& child : world->children) {
      if (child.name == "model") SettlePlacement(child, diagnostics_);
    }
    for (const XmlNode& child : world->children) {
      if (child.name == "model" || child.name == "frame") frames_.emplace(child.Attribute("name"), &child);
    }
    for (const XmlNode& child : world->children) {
      if (child.name == "model" && !HasAny(child, "link")) {  // Gazebo's worlds use these to hold plugins
        diagnostics_.Mended(child.where,
                            "model '" + child.Attribute("name") + "' has no link: it is left out");
      } else if (child.name == "model") {
        AddBodies(child);
      } else if (child.name == "light" && child.Attribute("type") == "point") {
        AddLight(child);
      } else if (child.name == "scene" && child.Child("ambient") != nullptr) {
        ReadAmbient(child);
      } else if (child.name == "plugin" && needless_.Take(child)) {
        // Reported below.
      } else if (child.name == "plugin") {
        LeaveOutPlugin(child, 1, diagnostics_);
      } else if (child.name != "physics" && child.name != "gravity" && child.name != "frame") {
        diagnostics_.LeftOut(child.where, "<" + child.name + "> in <world>");
      }
    }
    needless_.Say(diagnostics_);
    SayUnused();
    if (diagnostics_.has_errors()) return std::nullopt;
    if (floor_.empty() && !names_ground && world->name == "world") {
      diagnostics_.Mended(
          world->where,
          "the world has no ground plane, and gets a floor of 100 x 100 m at z = 0: write " +
              std::string(world->where.line == 0 ? "<geom type=\"plane\" size=\"50 50 1\"/>"
                                                 : "<include><uri>model://ground_plane</uri></include>") +
              " if that is meant");
    }
    return SdfWorld{"; The scenario that " + file_.filename().string() +
                        " means.\n[SIMULATION]\noverlaps yes\n" + simulation_ + "\n[FLOOR]\n" +
                        (floor_.empty() ? "size 100 100\n" : floor_) + things_ + lights_ + robots_,
                    std::move(models_), std::move(places_)};
  }

  /// True if `root` contains only one model, which is one robot.
  static bool IsOneRobot(const XmlNode& root) {
    if (root.name != "sdf" || CountModels(root) != 1) return false;
    const XmlNode* model = root.Child("model");
    return model == nullptr || HasOwnElements(*model) || HasAny(*model, "include") ||
           SplitLoose(*model).size() == 1;
  }

  /// The number of models directly in `root`, including <include>s.
  static std::ptrdiff_t CountModels(const XmlNode& root) {
    return std::ranges::count(root.children, "model", &XmlNode::name) +
           std::ranges::count(root.children, "include", &XmlNode::name);
  }

 private:
  /// The scenario of a file with a single model: one robot.
  SdfWorld OneRobot() const {
    return {"[ROBOT_1]\ntype \"" + file_.filename().string() + "\"\nposition 0 0\n", {}, {}};
  }

  void ReadSimulation(const XmlNode& world) {
    const auto gravity = SplitWords(world.TextOf("gravity"));
    if (gravity.size() == 3) {
      const auto x = ParsePlain(gravity[0]), y = ParsePlain(gravity[1]), z = ParsePlain(gravity[2]);
      if (!x || !y || !z) {
        diagnostics_.Mended(world.Child("gravity")->where,
                            "<gravity> must be three numbers, 0 0 -9.8: 9.81 m/s² down is taken");
      } else if (*x == 0 && *y == 0) {
        simulation_ += "gravity " + Exact(-*z) + "\n";
      } else {
        simulation_ += "gravity " + Exact(*x) + " " + Exact(*y) + " " + Exact(*z) + "\n";
      }
    }
    const XmlNode* physics = world.Child("physics");
    if (physics == nullptr) return;
    if (const auto step = ParsePlain(physics->TextOf("max_step_size"))) {
      const double kept = std::clamp(std::round(*step * 1e6) * 1e-6, 5e-4, 0.1);
      simulation_ += "step " + Exact(kept) + "\n";
      if (std::abs(kept - *step) > 1e-9)
        diagnostics_.Mended(physics->where,
                            "<max_step_size> lies between 0.5 ms and 100 ms: " + Exact(kept) + " s is taken");
    }
  }

  /// The first `count` numbers in `text`; 0 for missing and invalid ones.
  static std::vector<double> NumbersIn(const std::string& text, std::size_t count) {
    std::vector<double> values;
    for (const std::string& word : SplitWords(text)) values.push_back(ParsePlain(word).value_or(0));
    values.resize(count);
    return values;
  }

  void AddLight(const XmlNode& light) {
    const XmlNode* pose = light.Child("pose");
    if (pose != nullptr && pose->Has("relative_to"))
      diagnostics_.Note(pose->where, "relative_to of a light's <pose> is not used: it is x y z in the world");
    const std::vector<double> p = NumbersIn(pose == nullptr ? "" : pose->text, 3);
    std::string color = "1 1 1";
    if (!light.TextOf("diffuse").empty()) {
      const std::vector<double> c = NumbersIn(light.TextOf("diffuse"), 3);
      color = Exact(Vector3(c[0], c[1], c[2]).cwiseMin(1).cwiseMax(0));
    }
    // Attenuation at 1 m.
    double fade = 1;
    if (const XmlNode* attenuation = light.Child("attenuation")) {
      const auto part = [&](const char* key, double otherwise) {
        const auto value = ParsePlain(attenuation->TextOf(key));
        return value ? std::max(0.0, *value) : otherwise;
      };
      fade = part("constant", 1) + part("linear", 1) + part("quadratic", 0);
    }
    const double power =
        std::max(0.0, ParsePlain(light.TextOf("intensity")).value_or(1)) / std::max(fade, 1e-3);
    const std::string shadows = light.TextOf("cast_shadows");
    lights_ += "\n[LIGHT_" + std::to_string(++light_count_) + "]\nposition " +
               Exact(Vector3(p[0], p[1], p[2])) + "\ncolor " + color + "\npower " +
               Exact(std::min(power, 1e6)) + "\nshadows " +
               (shadows == "1" || shadows == "true" ? "yes" : "no") + "\n";
  }

  void ReadAmbient(const XmlNode& scene) {
    const std::vector<double> c = NumbersIn(scene.TextOf("ambient"), 3);
    simulation_ += "ambient_light " + Exact(std::clamp((c[0] + c[1] + c[2]) / 3, 0.0, 1e6)) + "\n";
    for (const XmlNode& child : scene.children) {
      if (child.name != "ambient") diagnostics_.LeftOut(child.where, "<" + child.name + "> in <scene>");
    }
  }

  std::string NewName(const std::string& given) {
    std::string name;
    for (const char c : given) {
      const bool good =
          (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
      name += good ? c : '_';
    }
    if (name.empty() || !((name[0] >= 'a' && name[0] <= 'z') || (name[0] >= 'A' && name[0] <= 'Z')))
      name = "m" + name;
    name.resize(std::min<std::size_t>(name.size(), 50));
    // Names that begin like these would be other sections.
    for (const char* word : {"world", "simulation", "target", "floor", "robot", "swarm", "light"}) {
      if (ToLower(name).starts_with(word)) name = "m_" + name;
    }
    const std::string word = ToLower(name.substr(0, name.find_first_of("_0123456789")));
    if (word == "set" || word == "random" || word == "score") name = "m_" + name;
    std::string unique = name;
    int& number = numbers_.try_emplace(name, 2).first->second;
    while (!names_.insert(ToLower(unique)).second) unique = name + "_" + std::to_string(number++);
    return unique;
  }

  /// Adds the model, or each of its bodies if no joints connect them.
  void AddBodies(const XmlNode& model) {
    const std::vector<XmlNode> bodies =
        HasOwnElements(model) ? std::vector<XmlNode>{model} : SplitLoose(model);
    for (const XmlNode& body : bodies) {
      constexpr int kMostModels = 3000;  // each takes about a millisecond
      if (++model_count_ > kMostModels) {
        if (model_count_ == kMostModels + 1) {
          diagnostics_.Error(body.where, "a world has at most " + std::to_string(kMostModels) +
                                             " models, and a model of loose links counts as one for each: "
                                             "leave some out, or write a scenario with [SWARM]");
        }
        return;
      }
      AddModel(body);
    }
  }

  /// X_WF of a model or `<frame>` of the world.
  Pose PoseInWorld(const XmlNode& framed, int depth = 0) {
    constexpr int kMostDeep = 100;
    const XmlNode* const pose = framed.Child("pose");
    std::string base = pose == nullptr ? "" : pose->Attribute("relative_to");
    if (base.empty()) base = framed.Attribute("attached_to");
    Pose X_WB;
    if (!base.empty() && base != "world") {
      const auto found = frames_.find(base);
      if (found != frames_.end() && depth < kMostDeep) {
        X_WB = PoseInWorld(*found->second, depth + 1);
      } else {
        diagnostics_.Warning(framed.where, "there is no model or frame '" + base +
                                               "' in the world that a <pose> could be relative_to: it is one "
                                               "in the world");
      }
    }
    return X_WB * PoseOf(pose);
  }

  void AddModel(const XmlNode& given) {
    XmlNode root;
    root.name = "sdf";
    root.where = given.where;
    root.Set("version", "1.9");
    root.children.push_back(given);
    XmlNode& model = root.children.back();
    const Pose X_WM = PoseInWorld(model);
    std::erase_if(model.children, [](const XmlNode& one) { return one.name == "pose"; });
    if (IsGround(model, X_WM)) return;
    const bool places_mass = PlacesMass(model);
    const std::string name = NewName(model.Attribute("name"));
    const std::string type = ShortWorldModelType(file_, name);
    const auto read =
        ReadRobotModelTree(std::move(root), file_.string(), type, &resources_, true, diagnostics_);
    if (read == nullptr) return;
    Pose X_WR = X_WM * Pose{read->p_MR, Quaternion::Identity()};
    const bool are_things = AreThings(*read) && !(places_mass && HasOwnInertia(*read, name, given.where));
    double below_m = -LowestOf(*read, X_WR);
    if (!are_things) below_m = std::max(below_m, -X_WR.p.z());
    if (below_m > 0) X_WR.p.z() += below_m;
    if (below_m > 1e-3) {
      diagnostics_.Mended(given.where, "model '" + name + "' stands " +
                                           FormatNumber(std::round(below_m * 1e4) / 1e4) +
                                           " m below the floor: it is put on the floor");
    }
    models_.emplace(name, read);  // a thing may also serve as a robot's type
    places_.emplace(name, given.where);
    if (are_things) return AddThings(*read, name, X_WR);
    robots_ += "\n[ROBOT_" + std::to_string(++robot_count_) + "]\ntype " + type + "\nname " + name +
               "\nposition " + Exact(X_WR.p) + "\norientation " + Angles(X_WR.q) + "\n";
    if (!read->has_actuators() && read->sensors.size() <= 1) robots_ += "sockets no\n";
  }

  /// True if the model is a static horizontal plane at z = 0, which becomes the floor.
  bool IsGround(const XmlNode& model, const Pose& X_WM) {
    const XmlNode* link = model.Child("link");
    const XmlNode* collision = link == nullptr ? nullptr : link->Child("collision");
    const XmlNode* geometry = collision == nullptr ? nullptr : collision->Child("geometry");
    const XmlNode* plane = geometry == nullptr ? nullptr : geometry->Child("plane");
    if (plane == nullptr || std::abs(X_WM.p.z()) > 1e-3 || !floor_.empty()) return false;
    Vector3 normal = Vector3::UnitZ();
    const std::vector<std::string> xyz = SplitWords(plane->TextOf("normal"));
    for (int i = 0; i < 3 && xyz.size() == 3; ++i)
      normal[i] = ParsePlain(xyz[static_cast<std::size_t>(i)]).value_or(0);
    if ((X_WM.q * normal).z() < 0.999 * normal.norm()) return false;
    const std::vector<std::string> size = SplitWords(plane->TextOf("size"));
    const auto length = size.size() == 2 ? ParsePlain(size[0]) : std::nullopt;
    const auto width = size.size() == 2 ? ParsePlain(size[1]) : std::nullopt;
    constexpr double kSmallest_m = 10;
    floor_ = "size " + Exact(std::max(kSmallest_m, length.value_or(100))) + " " +
             Exact(std::max(kSmallest_m, width.value_or(100))) + "\n";
    return true;
  }

  /// True if no model is needed: it is static and made of simple shapes, or is a single simple shape.
  static bool AreThings(const RobotModel& model) {
    const bool senses = std::ranges::any_of(
        model.sensors, [](const SensorModel& one) { return !std::holds_alternative<PoseModel>(one.kind); });
    if (model.links.size() != 1 || !model.joints.empty() || senses) return false;
    const LinkModel& link = model.links.front();
    // Things are hard. Where its own weight presses a model in by less, nobody sees a difference.
    constexpr double kHard_m = 1e-4, kUsual_m_s2 = 9.81;
    const double weight_n = kUsual_m_s2 * (model.fixed_base ? 1 : link.mass_kg);
    const bool simple = std::ranges::all_of(link.collisions, [&](const LinkShape& one) {
      const bool is_ball = std::holds_alternative<Sphere>(one.shape);
      return one.shape.index() <= 2 && one.friction_along_G.isZero() &&
             weight_n <= kHard_m * one.contact_stiffness_n_m &&
             one.spinning_friction_m == (is_ball ? one.rolling_friction_m : 0);
    });
    if (!simple || link.collisions.empty() || (!model.fixed_base && link.collisions.size() != 1))
      return false;
    // Visual meshes need the model.
    return std::ranges::none_of(link.visuals, [](const LinkShape& one) { return one.shape.index() > 2; });
  }

  /// True if the mass of a moving single shape lies elsewhere than in the uniform solid, so that the model
  /// cannot be a thing: off the centre, or nearer to or further from the centre of a ball. Boxes and
  /// cylinders remain things, because the moments in most files do not fit their shapes, and so do balls
  /// with moments that no mass inside them can have, such as 1 1 1: SayUnused() reports them.
  bool HasOwnInertia(const RobotModel& model, const std::string& name, const SourceLine& where) {
    if (model.fixed_base) return false;
    const LinkModel& link = model.links.front();
    const MassPlace place = CompareWithSolid(link);
    if (!place.is_centred) return true;
    if (place.is_uniform) return false;
    constexpr double kSurface = 2.5 * 1.05;  // m r² instead of 2/5 m r²
    const bool is_ball = std::holds_alternative<Sphere>(link.collisions.front().shape);
    if (is_ball && place.moments_kg_m2.maxCoeff() <= kSurface * place.solid_kg_m2.x()) return true;
    if (++unused_count_ == 1) {
      unused_where_ = where;
      unused_ = "the moments of inertia of model '" + name + "', " + Rounded(place.moments_kg_m2) +
                ", are not used: it is a thing, with those of the uniform solid, " +
                Rounded(place.solid_kg_m2) + "; a scenario with [ROBOT_1] type " + file_.filename().string() +
                "#" + name + " uses them";
    }
    return false;
  }

  void SayUnused() {
    if (unused_count_ == 0) return;
    const int others = unused_count_ - 1;
    const std::string more =
        "; likewise " + std::to_string(others) + " other model" + (others == 1 ? "" : "s");
    diagnostics_.Mended(unused_where_, unused_ + (others == 0 ? "" : more));
  }

  static std::string Rounded(const Vector3& v) {
    char text[80];
    std::snprintf(text, sizeof(text), "%.3g %.3g %.3g", v.x(), v.y(), v.z());
    return text;
  }

  void AddThings(const RobotModel& model, const std::string& name, const Pose& X_WR) {
    const LinkModel& link = model.links.front();
    int number = 0;
    for (const LinkShape& shape : link.collisions) {
      const Pose X_WG = X_WR * link.X_RL * shape.X_LG;
      const Color color = link.visuals.empty() ? Color() : link.visuals.front().color;
      const std::string part = ++number == 1 ? name : NewName(name + "_" + std::to_string(number));
      places_.emplace(part, places_.at(name));
      things_ += "\n[" + part + "]\n";
      if (const auto* box = std::get_if<Box>(&shape.shape)) {
        things_ += "type box\nsize " + Exact(box->size_m) + "\n";
      } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.shape)) {
        things_ += "type cylinder\nsize " +
                   Exact(Vector3(2 * cylinder->radius_m, 2 * cylinder->radius_m, cylinder->length_m)) + "\n";
      } else {
        things_ += "type sphere\nsize " + Exact(2 * std::get<Sphere>(shape.shape).radius_m) + "\n";
      }
      things_ += "position " + Exact(X_WG.p) + "\norientation " + Angles(X_WG.q) + "\ncolor " +
                 Exact(Vector3(color.r, color.g, color.b)) + "\nfriction " + Exact(shape.friction) + "\n";
      if (shape.restitution > 0) things_ += "bounce " + Exact(shape.restitution) + "\n";
      // Round things that move have some by default.
      if (shape.rolling_friction_m > 0 || (!model.fixed_base && !std::holds_alternative<Box>(shape.shape)))
        things_ += "rolling_friction " + Exact(shape.rolling_friction_m) + "\n";
      if (!model.fixed_base) things_ += "mass " + Exact(link.mass_kg) + "\n";
    }
  }

  const std::filesystem::path file_;
  const Resources resources_;
  Diagnostics& diagnostics_;
  NeedlessPlugins needless_;
  std::string simulation_, floor_, things_, lights_, robots_;
  std::map<std::string, std::shared_ptr<const RobotModel>> models_;  // by new name
  std::map<std::string, SourceLine> places_;
  std::map<std::string, const XmlNode*> frames_;  // models and frames of the world
  std::set<std::string> names_;
  std::map<std::string, int> numbers_;  // next suffix, by name
  int model_count_ = 0, robot_count_ = 0, light_count_ = 0;
  int unused_count_ = 0;  // things whose moments of inertia are not used
  std::string unused_;    // about the first of them
  SourceLine unused_where_;
};

}  // namespace

bool IsOneSdfModel(const std::string& text) {
  Diagnostics ignored;
  const auto root = ParseXml(text, "", ignored);
  if (!root || root->Child("world") != nullptr) return !root;
  return WorldConverter::IsOneRobot(*root) || WorldConverter::CountModels(*root) == 0;
}

std::optional<SdfWorld> ReadSdfWorld(const std::filesystem::path& file, const SearchPath& path,
                                     Diagnostics& diagnostics) {
  const auto text = ReadTextFile(file.string(), {file.string(), 0}, diagnostics);
  if (!text) return std::nullopt;
  if (IsMjcf(*text)) {
    MeshFolder meshes;
    auto root = ReadMjcf(file, path, meshes, diagnostics);
    if (!root) return std::nullopt;
    return WorldConverter(file, ResourcesOf(path, file, meshes), diagnostics).Convert(std::move(*root));
  }
  auto root = ParseXml(*text, file.string(), diagnostics);
  if (!root) return std::nullopt;
  return WorldConverter(file, Resources(path, file), diagnostics).Convert(std::move(*root));
}

}  // namespace coopdyn
