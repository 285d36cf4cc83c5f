// SPDX-License-Identifier: MIT
#include "server/rosiml/write_sdf.h"

#include <algorithm>
#include <map>

#include "server/base/printable.h"
#include "server/rosiml/names.h"
#include "server/rosiml/write_channel.h"
#include "server/rosiml/write_joints.h"

namespace coopdyn::rosiml {

namespace {

std::string Escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

std::string GeometryOf(const Part& part) {
  const Shape& shape = part.shape;
  std::string inside;
  if (std::holds_alternative<Mesh>(shape)) {
    inside = Tag("mesh", Tag("uri", Escaped(part.mesh_file)));
  } else if (const auto* box = std::get_if<Box>(&shape)) {
    inside = Tag("box", Tag("size", Places(box->size_m)));
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    inside = Tag("sphere", Tag("radius", Exact(sphere->radius_m)));
  } else {
    const auto* cylinder = std::get_if<Cylinder>(&shape);
    const auto* capsule = std::get_if<Capsule>(&shape);
    const double radius = cylinder != nullptr ? cylinder->radius_m : capsule->radius_m;
    const double length = cylinder != nullptr ? cylinder->length_m : capsule->length_m;
    inside = Tag(cylinder != nullptr ? "cylinder" : "capsule",
                 Tag("radius", Exact(radius)) + Tag("length", Exact(length)));
  }
  return Tag("geometry", inside);
}

class SdfWriter {
 public:
  SdfWriter(const Movable& movable, const Model& model, const std::string& file, Diagnostics& diagnostics)
      : movable_(movable), model_(model), file_(file), diagnostics_(diagnostics) {}

  WrittenModel Write(const std::string& name) {
    // The extent of meshes is unknown until their files are read.
    const bool lifts = std::ranges::any_of(model_.bodies, [this](int body) { return HasMesh(BodyOf(body)); });
    Add(movable_.line, std::string("<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"") +
                           (lifts ? " coopdyn:lift=\"true\">" : ">"));
    Add(movable_.line, "<model name=\"" + name + "\">");
    for (const int body : model_.bodies) WriteBody(body);
    joints_ = WriteJoints(movable_, model_, links_, file_, names_, written_, diagnostics_);
    WriteSensors();
    WriteExchange();
    written_.AddModule(movable_.line, "pose", "pose");
    Add(movable_.line, "</model>");
    Add(movable_.line, "</sdf>");
    return std::move(written_);
  }

 private:
  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }
  const Body& BodyOf(int body) const { return movable_.bodies[Index(body)]; }
  static bool HasMesh(const Body& body) {
    return std::ranges::any_of(body.parts, [](const Part& part) { return !part.mesh_file.empty(); });
  }
  void Add(int line, const std::string& text) { written_.sdf.Add(line, text); }
  void Warn(int line, std::string text) { diagnostics_.Warning({file_, line}, std::move(text)); }

  void WriteBody(int index) {
    const Body& body = BodyOf(index);
    const std::string& name = links_.emplace(index, names_.New(body.name)).first->second;
    Add(body.line, "<link name=\"" + name + "\">");
    Add(body.line, Tag("pose", Places(model_.X_WR.Inverse() * body.X_WB)));
    WriteInertia(body);
    int number = 0;
    for (const Part& part : body.parts) {
      const std::string shape = Tag("pose", Places(part.X_BG)) + GeometryOf(part);
      const std::string part_name = "\"s" + std::to_string(++number) + "\"";
      std::string surface = Tag("friction", Tag("ode", Tag("mu", Exact(body.friction))));
      if (body.restitution > 0)
        surface += Tag("bounce", Tag("restitution_coefficient", Exact(std::min(body.restitution, 1.0))));
      Add(part.line, "<collision name=" + part_name + ">" + shape + Tag("surface", surface) + "</collision>");
      std::string colour = part.colour.empty() ? body.colour : part.colour;
      if (colour.empty() && !movable_.is_robot) colour = "0.6 0.6 0.6";
      Add(part.line, "<visual name=" + part_name + (colour.empty() ? " coopdyn:color=\"robot\"" : "") + ">" +
                         shape + (colour.empty() ? "" : Tag("material", Tag("diffuse", colour + " 1"))) +
                         "</visual>");
    }
    Add(body.line, "</link>");
  }

  void WriteInertia(const Body& body) {
    // A fixed body may have any mass.
    double mass_kg = body.mass_kg;
    std::vector<double> masses;
    for (const Part& part : body.parts) masses.push_back(mass_kg > 0 ? part.mass_kg : 1);
    double sum = 0;
    for (const double mass : masses) sum += mass;
    if (mass_kg <= 0) mass_kg = sum > 0 ? sum : 1;
    Vector3 centre = Vector3::Zero();
    for (std::size_t i = 0; i < masses.size() && sum > 0; ++i)
      centre += masses[i] / sum * body.parts[i].X_BG.p;
    Matrix3 inertia = Matrix3::Zero();
    for (std::size_t i = 0; i < masses.size(); ++i) {
      const Part& part = body.parts[i];
      const Matrix3 R = part.X_BG.q.toRotationMatrix();
      const Vector3 d = part.X_BG.p - centre;
      if (!part.mesh_file.empty()) continue;
      inertia += R * SolidInertia(part.shape, masses[i]).asDiagonal() * R.transpose() +
                 masses[i] * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
    }
    if (body.centre_of_mass) centre = *body.centre_of_mass;
    if (HasMesh(body)) {
      // The reader of the mesh file knows its shape, so it computes the inertia.
      Add(body.line, "<inertial coopdyn:solid=\"true\">" +
                         Tag("pose", Places(Pose{centre, Quaternion::Identity()})) +
                         Tag("mass", Exact(mass_kg)) + "</inertial>");
      return;
    }
    Add(body.line,
        "<inertial>" + Tag("pose", Places(Pose{centre, Quaternion::Identity()})) +
            Tag("mass", Exact(mass_kg)) +
            Tag("inertia", Tag("ixx", Exact(inertia(0, 0))) + Tag("iyy", Exact(inertia(1, 1))) +
                               Tag("izz", Exact(inertia(2, 2))) + Tag("ixy", Exact(inertia(0, 1))) +
                               Tag("ixz", Exact(inertia(0, 2))) + Tag("iyz", Exact(inertia(1, 2)))) +
            "</inertial>");
  }

  bool IsHere(const Sensor& sensor) const { return links_.contains(sensor.body); }

  /// link="…" pose="…" of a sensor.
  std::string PlaceOf(const Sensor& sensor) {
    const Pose X_BS = BodyOf(sensor.body).X_WB.Inverse() * sensor.X_WS;
    return " link=\"" + links_[sensor.body] + "\" pose=\"" + Places(X_BS) + "\"";
  }

  /// True if the sensor belongs to the module `distance`: rays side by side on the base. All other proximity
  /// sensors belong to the module `sonar`.
  bool IsFan(const Sensor& sensor) const {
    return sensor.kind == Sensor::Kind::kProximity && sensor.pattern == Sensor::Pattern::kFan &&
           model_.is_base[Index(sensor.body)];
  }
  static std::string NoiseOf(const Sensor& sensor) {
    return sensor.noise > 0 ? " noise_stddev=\"" + Exact(sensor.noise) + "\"" : "";
  }

  void WriteSensors() {
    using Kind = Sensor::Kind;
    WriteAll("distance_sensors", "distance", [this](const Sensor& one) {
      if (!IsFan(one)) return std::string();
      return "<coopdyn:sector pose=\"" + Places(model_.X_WR.Inverse() * one.X_WS) + "\" max_range=\"" +
             Exact(one.range_m) + "\" opening_deg=\"" + Exact(std::min(one.opening_deg, 360.0)) +
             "\" rays=\"" + std::to_string(std::clamp(one.rays, one.opening_deg > 0 ? 2 : 1, 1000)) + "\"" +
             NoiseOf(one) + "/>";
    });
    SortDistances();
    WriteAll("sonar", "sonar", [this](const Sensor& one) {
      if (one.kind != Kind::kProximity || IsFan(one)) return std::string();
      if (one.pattern == Sensor::Pattern::kFan)
        Warn(one.line, "only the robot's base has a fan: '" + Printable(one.name) + "' is a cone");
      const bool is_cone = one.pattern != Sensor::Pattern::kCross;
      return "<coopdyn:beam" + PlaceOf(one) + " max_range=\"" + Exact(one.range_m) + "\" opening_deg=\"" +
             Exact(std::min(one.opening_deg, is_cone ? 170.0 : 360.0)) + "\"" +
             (is_cone ? ""
                      : " opening_up_deg=\"" + Exact(std::min(one.opening_up_deg, 360.0)) + "\" rays=\"" +
                            std::to_string(std::clamp(one.rays, 1, 1000)) + "\"") +
             NoiseOf(one) + "/>";
    });
    WriteAll("light", "light", [this](const Sensor& one) {
      if (one.kind != Kind::kLight) return std::string();
      const bool has_colour =
          !one.colour.empty() && one.colour.find_first_of("123456789") != std::string::npos;
      return "<coopdyn:eye" + PlaceOf(one) + " opening_deg=\"" +
             Exact(one.opening_deg < 360 ? one.opening_deg : 0) + "\"" +
             (has_colour ? " color=\"" + one.colour + "\"" : "") + "/>";
    });
    for (const Sensor& one : movable_.sensors) {
      if (IsHere(one)) WriteOne(one);
    }
  }

  /// Writes one module for all sensors of a kind. `write` returns a sensor's line; empty for other kinds.
  template <typename Write>
  void WriteAll(const std::string& element, const char* type, Write write) {
    MadeText all;
    for (const Sensor& one : movable_.sensors) {
      const std::string text = IsHere(one) ? write(one) : "";
      if (text.empty()) continue;
      all.Add(one.line, text);
      readings_[&one] = {type, static_cast<int>(all.lines.size())};
    }
    if (all.lines.empty()) return;
    const int line = all.lines.front();
    Add(line, "<coopdyn:" + element + ">");
    written_.sdf.text += all.text;
    written_.sdf.lines.insert(written_.sdf.lines.end(), all.lines.begin(), all.lines.end());
    Add(line, "</coopdyn:" + element + ">");
    written_.AddModule(line, type, type);
  }

  /// Sorts the readings of the module `distance` from right to left.
  void SortDistances() {
    std::vector<std::pair<double, const Sensor*>> order;
    for (const Sensor& one : movable_.sensors) {
      if (const auto found = readings_.find(&one);
          found != readings_.end() && found->second.first == "distance")
        order.emplace_back(Heading((model_.X_WR.Inverse() * one.X_WS).q), &one);
    }
    std::ranges::stable_sort(order, {}, &std::pair<double, const Sensor*>::first);
    for (std::size_t i = 0; i < order.size(); ++i)
      readings_[order[i].second].second = static_cast<int>(i) + 1;
  }

  /// The name at `index`; empty if it is not in this model.
  static std::string NameIn(const std::map<int, std::string>& names, int index) {
    const auto found = names.find(index);
    return found == names.end() ? std::string() : found->second;
  }

  /// Writes the values that YARS clients exchange.
  void WriteExchange() {
    const auto sensor_of = [this](int sensor) { return readings_.find(&movable_.sensors[Index(sensor)]); };
    const MadeText channel = WriteChannel(
        movable_, {.joint =
                       [this](int joint) {
                         for (std::size_t i = 0; i < model_.links.size(); ++i) {
                           if (model_.links[i].joint == joint) return joints_.joints[i];
                         }
                         return std::string();
                       },
                   .muscle = [this](int muscle) { return NameIn(joints_.muscles, muscle); },
                   .thruster = [this](int thruster) { return NameIn(joints_.thrusters, thruster); },
                   .place =
                       [this](int body, const Pose& X_WN) {
                         if (!links_.contains(body)) return std::string();
                         const Pose X_BN = BodyOf(body).X_WB.Inverse() * X_WN;
                         return " link=\"" + links_[body] + "\" pose=\"" + Places(X_BN) + "\"";
                       },
                   .reading =
                       [&](int sensor) {
                         const auto found = sensor_of(sensor);
                         if (found == readings_.end()) return std::string();
                         return " module=\"" + found->second.first + "\" index=\"" +
                                std::to_string(found->second.second) + "\"";
                       },
                   .module =
                       [&](int sensor) {
                         const auto found = sensor_of(sensor);
                         return found == readings_.end() ? std::string() : found->second.first;
                       }});
    written_.sdf.text += channel.text;
    written_.sdf.lines.insert(written_.sdf.lines.end(), channel.lines.begin(), channel.lines.end());
    written_.has_modules = written_.has_modules || !channel.lines.empty();
  }

  /// Writes the sensor as its own module.
  void WriteOne(const Sensor& sensor) {
    using Kind = Sensor::Kind;
    if (sensor.kind == Kind::kProximity || sensor.kind == Kind::kLight) return;
    const std::string name = modules_.New(ModuleName(sensor.name));
    readings_[&sensor] = {name, 1};
    const auto write = [&](const char* type, const std::string& attributes, const std::string& inside = "") {
      const std::string element = std::string("coopdyn:") + type;
      Add(sensor.line, "<" + element + " name=\"" + name + "\"" + attributes +
                           (inside.empty() ? "/>" : ">" + inside + "</" + element + ">"));
      written_.AddModule(sensor.line, type, name);
    };
    switch (sensor.kind) {
      case Kind::kCompass:
        return write("compass", " noise_stddev_deg=\"" + Exact(std::min(sensor.noise, 180.0)) + "\"");
      case Kind::kNeighbours:
        return write("neighbours", " range=\"" + Exact(sensor.range_m) + "\"");
      case Kind::kContact:
        return write("contact", " links=\"" + links_[sensor.body] + "\"");
      case Kind::kImu:
        return write("imu", PlaceOf(sensor));
      case Kind::kSharp:
        return write("infrared", " preset=\"" + sensor.model + "\"", "<coopdyn:eye" + PlaceOf(sensor) + "/>");
      case Kind::kAmbient:
        return write("light", "", "<coopdyn:eye lamps=\"false\"/>");
      default:
        return write("camera", PlaceOf(sensor) + " width=\"" + std::to_string(sensor.width) + "\" height=\"" +
                                   std::to_string(sensor.height) + "\" fov_deg=\"" +
                                   Exact(sensor.opening_deg) + "\"");
    }
  }

  const Movable& movable_;
  const Model& model_;
  const std::string& file_;
  Diagnostics& diagnostics_;
  WrittenModel written_;
  Names names_{"world"};
  Names modules_{"motors", "distance", "sonar", "light", "pose", "joints", "muscles", "thrusters", "channel"};
  std::map<const Sensor*, std::pair<std::string, int>> readings_;  // module and index of its value
  std::map<int, std::string> links_;                               // link names, by body
  JointNames joints_;
};

}  // namespace

std::string Tag(const char* tag, const std::string& text) {
  return std::string("<") + tag + ">" + text + "</" + tag + ">";
}

void WrittenModel::AddModule(int line, const char* type, const std::string& name) {
  sdf.Add(line, std::string("<coopdyn:module type=\"") + type + "\" name=\"" + name + "\"/>");
  has_modules = has_modules || std::string_view(type) != "pose";
}

WrittenModel WriteSdf(const Movable& movable, const Model& model, const std::string& name,
                      const std::string& file, Diagnostics& diagnostics) {
  return SdfWriter(movable, model, file, diagnostics).Write(name);
}

}  // namespace coopdyn::rosiml
