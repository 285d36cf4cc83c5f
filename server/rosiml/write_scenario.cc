// SPDX-License-Identifier: MIT
#include "server/rosiml/write_scenario.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <ranges>
#include <set>
#include <utility>

#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/rosiml/connect.h"
#include "server/rosiml/names.h"
#include "server/rosiml/write_sdf.h"

namespace coopdyn::rosiml {

namespace {

class ScenarioWriter {
 public:
  ScenarioWriter(const std::string& file, const std::string& prefix, Diagnostics& diagnostics)
      : file_(file), prefix_(prefix), diagnostics_(diagnostics) {}

  Translation Write(const Experiment& experiment) {
    if (!experiment.simulation.empty()) Head("SIMULATION", experiment.simulation.front().line);
    for (const Setting& setting : experiment.simulation) Add(setting.line, setting.text);
    Randomise("SIMULATION", "ambient_light", {&experiment.ambient, "value"});
    WriteFloor(experiment);
    int lights = 0;
    for (const Light& light : experiment.lights) {
      const std::string section = "LIGHT_" + std::to_string(++lights);
      called_.emplace(light.name, section);
      if (light.is_sound) WriteLight(light, section);
    }
    for (const Movable& thing : experiment.things) {
      if (LeavesOut(thing)) continue;
      if (IsThing(thing)) WriteThing(thing);
    }
    // Robots first, so that robot n becomes [ROBOT_n].
    for (const Movable& robot : experiment.robots) {
      if (!LeavesOut(robot)) WriteRobots(robot);
    }
    for (const Movable& thing : experiment.things) {
      if (thing.is_sound && !IsThing(thing)) WriteRobots(thing);
    }
    for (const Score& score : experiment.scores) {
      if (score.is_sound) WriteScore(score);
    }
    if (!random_.lines.empty()) {
      Head("RANDOM", random_.lines.front());
      out_.scenario.text += random_.text;
      out_.scenario.lines.insert(out_.scenario.lines.end(), random_.lines.begin(), random_.lines.end());
    }
    return std::move(out_);
  }

 private:
  /// True if the movable has errors. Registers its name, so that references to it remain valid.
  bool LeavesOut(const Movable& movable) {
    if (!movable.is_sound) called_.emplace(movable.name, movable.name);
    return !movable.is_sound;
  }

  /// A range of a <randomise>, if present.
  struct Drawn {
    const Random* random = nullptr;
    const char* key = nullptr;
    double otherwise = 0;
    double shift = 0;  // added to the file's values

    const std::pair<double, double>* range() const {
      const auto found = random->ranges.find(key);
      return found == random->ranges.end() ? nullptr : &found->second;
    }
    std::string Words(const char* unit = "") const {
      if (range() == nullptr) return Rounded(otherwise);
      const double least = range()->first + shift, most = range()->second + shift;
      return least == most ? Rounded(least) + unit
                           : "uniform " + Rounded(least) + unit + " " + Rounded(most) + unit;
    }
  };

  void Add(int line, const std::string& text) { out_.scenario.Add(line, text); }
  void Head(const std::string& name, int line) { Add(line, "[" + name + "]"); }

  void Randomise(const std::string& section, const std::string& key, const Drawn& drawn) {
    if (drawn.range() != nullptr) random_.Add(drawn.random->line, section + "." + key + " " + drawn.Words());
  }
  void RandomisePlace(const std::string& section, const Random& random, const Vector3& p, double shift_z) {
    const Drawn x{&random, "x", p.x()}, y{&random, "y", p.y()}, z{&random, "z", p.z(), shift_z};
    if (x.range() == nullptr && y.range() == nullptr && z.range() == nullptr) return;
    random_.Add(random.line, section + ".position " + x.Words() + " " + y.Words() + " " + z.Words());
  }
  void RandomiseHeading(const std::string& section, const Random& random, const Quaternion& q) {
    const Drawn gamma{&random, "gamma"};
    if (gamma.range() == nullptr) return;
    const std::string angles = RollPitchYaw(q);
    random_.Add(random.line,
                section + ".orientation " + angles.substr(0, angles.rfind(' ')) + " " + gamma.Words("deg"));
  }

  void WriteFloor(const Experiment& experiment) {
    const int line = experiment.floor.empty() ? 1 : experiment.floor.front().line;
    Head("FLOOR", line);
    double half_m = 8;  // large enough for everything that stands on the floor, with a margin
    const auto reach = [&half_m](const Movable& movable) {
      for (const Body& body : movable.bodies)
        half_m = std::max({half_m, std::abs(body.X_WB.p.x()), std::abs(body.X_WB.p.y())});
    };
    std::ranges::for_each(experiment.things, reach);
    std::ranges::for_each(experiment.robots, reach);
    const double side_m = std::min(2 * (std::ceil(half_m) + 2), 1e5);
    const auto [length_m, width_m] = experiment.floor_size.value_or(std::pair(side_m, side_m));
    Add(line, "size " + Exact(length_m) + " " + Exact(width_m));
    for (const Setting& setting : experiment.floor) Add(setting.line, setting.text);
  }

  void WriteLight(const Light& light, const std::string& section) {
    Head(section, light.line);
    Add(light.line, "position " + Places(light.p_W));
    if (!light.colour.empty()) Add(light.line, "color " + light.colour);
    Add(light.line, "power " + Exact(light.power));
    if (!light.shadows) Add(light.line, "shadows no");
    RandomisePlace(section, light.random, light.p_W, 0);
    Randomise(section, "power", {&light.random, "power"});
  }

  /// True if the movable is a single simple shape, which needs no model.
  static bool IsThing(const Movable& movable) {
    const Body& body = movable.bodies.front();
    if (body.parts.size() != 1 || body.restitution > 0 || body.centre_of_mass) return false;
    const bool is_moved =
        !body.parts.front().X_BG.p.isZero() || !body.parts.front().X_BG.q.isApprox(Quaternion::Identity());
    return !std::holds_alternative<Capsule>(body.parts.front().shape) &&
           !std::holds_alternative<Mesh>(body.parts.front().shape) &&
           !(is_moved && !movable.random.ranges.empty());
  }

  void WriteThing(const Movable& thing) {
    const Body& body = thing.bodies.front();
    const Part& part = body.parts.front();
    const Pose X_WG = body.X_WB * part.X_BG;
    const std::string section = names_.New(ThingName(thing.name));
    called_.emplace(thing.name, section);
    Head(section, thing.line);
    if (const auto* box = std::get_if<Box>(&part.shape)) {
      Add(part.line, "type box");
      Add(part.line, "size " + Places(box->size_m));
    } else if (const auto* cylinder = std::get_if<Cylinder>(&part.shape)) {
      const double across_m = 2 * cylinder->radius_m;
      Add(part.line, "type cylinder");
      Add(part.line, "size " + Places(Vector3(across_m, across_m, cylinder->length_m)));
    } else {
      Add(part.line, "type sphere");
      Add(part.line, "size " + Exact(2 * std::get<Sphere>(part.shape).radius_m));
    }
    Add(thing.line, "position " + Places(X_WG.p));
    Add(thing.line, "orientation " + RollPitchYaw(X_WG.q));
    if (body.mass_kg > 0) Add(thing.line, "mass " + Exact(body.mass_kg));
    Add(thing.line, "friction " + Exact(std::min(body.friction, 1000.0)));
    const std::string& colour = part.colour.empty() ? body.colour : part.colour;
    if (!colour.empty()) Add(thing.line, "color " + colour);
    RandomisePlace(section, thing.random, X_WG.p, 0);
    RandomiseHeading(section, thing.random, X_WG.q);
    Randomise(section, "mass", {&thing.random, "mass"});
    Randomise(section, "friction", {&thing.random, "friction"});
  }

  /// `name`, with a prefix if it begins like the name of another section.
  static std::string ThingName(const std::string& name) {
    const std::string lower = ToLower(Simple(name, 63));
    for (const char* word :
         {"world", "simulation", "target", "floor", "robot", "swarm", "light", "score", "random", "set"}) {
      if (lower.starts_with(word)) return "m_" + name;
    }
    return name;
  }

  /// Reports an error and returns true if there are too many models, which would take minutes to read.
  bool IsFull(const Movable& movable) {
    constexpr std::size_t kMostModels = 300;
    if (out_.models.size() < kMostModels) return false;
    if (!is_full_)
      diagnostics_.Error({file_, movable.line},
                         "an experiment has at most 300 robots, loose bodies and objects of several shapes");
    is_full_ = true;
    return true;
  }

  static std::vector<std::string> MeshFilesOf(const Movable& movable, const Model& model) {
    std::set<std::string> files;
    for (const int body : model.bodies) {
      for (const Part& part : movable.bodies[static_cast<std::size_t>(body)].parts) {
        if (!part.mesh_file.empty()) files.insert(part.mesh_file);
      }
    }
    return {files.begin(), files.end()};
  }

  void WriteRobots(const Movable& movable) {
    const std::vector<Model> models = Connect(movable, file_, diagnostics_);
    for (std::size_t i = 0; i < models.size() && !IsFull(movable); ++i) {
      const Model& model = models[i];
      const Body& base = movable.bodies[static_cast<std::size_t>(model.bodies.front())];
      const std::string name = names_.New(i == 0 ? movable.name : movable.name + "_" + base.name);
      if (i == 0) {
        called_.emplace(movable.name, name);
        written_.emplace(movable.name, &movable);
      }
      WrittenModel written = WriteSdf(movable, model, name, file_, diagnostics_);
      const int line = i == 0 ? movable.line : base.line;
      const std::string section = "ROBOT_" + std::to_string(++robots_);
      Head(section, line);
      Add(line, "type " + prefix_ + name);
      Add(line, "name " + name);
      Vector3 p = model.X_WR.p;
      p.z() += model.lift_m;
      Add(line, "position " + Places(p));
      Add(line, "orientation " + RollPitchYaw(model.X_WR.q));
      if (!movable.colour.empty()) Add(line, "color " + movable.colour);
      if (i == 0 && !movable.controller.empty()) Add(line, "controller " + movable.controller);
      if (!written.has_modules) Add(line, "sockets no");
      out_.models.push_back({name, prefix_ + name, std::move(written.sdf), MeshFilesOf(movable, model)});
      if (i > 0) continue;
      RandomisePlace(section, movable.random, p, p.z() - base.X_WB.p.z());
      RandomiseHeading(section, movable.random, model.X_WR.q);
      for (const char* key : {"mass", "friction"}) {
        if (Drawn{&movable.random, key}.range() != nullptr)
          diagnostics_.Error({file_, movable.random.line},
                             std::string("the ") + key +
                                 " of an object of several shapes, of a capsule or with 'bounce' "
                                 "cannot be randomised: leave it out");
      }
    }
  }

  /// Writes a score. Call it after everything that a score may name has been written.
  void WriteScore(const Score& score) {
    Head("SCORE_" + std::to_string(++scores_), score.line);
    for (const std::string& key : score.keys) Add(score.line, key);
    std::string of;
    for (const std::string& name : score.of) of += " " + NameOf(name, score.line);
    if (!of.empty()) Add(score.line, "of" + of);
    if (!score.target.empty()) Add(score.line, "target " + NameOf(score.target, score.line));
  }

  void CheckObject(const std::string& movable, const std::string& object, int line) {
    const auto found = written_.find(movable);
    if (found == written_.end()) return;
    const std::vector<Named>& names = found->second->names;
    if (std::ranges::find(names, object, &Named::name) != names.end()) return;
    diagnostics_.Error({file_, line}, "<score> names '" + Printable(object) + "', which is no object of '" +
                                          Printable(movable) + "'" +
                                          MeantOf(object, names, &Named::name, diagnostics_));
  }

  /// The scenario's name of the experiment's `name`.
  std::string NameOf(const std::string& name, int line) {
    const auto found = called_.find(name);
    if (found != called_.end()) return found->second;
    const std::size_t slash = name.find('/');
    if (slash != std::string::npos) {
      const std::string movable = name.substr(0, slash), object = name.substr(slash + 1);
      CheckObject(movable, object, line);
      return NameOf(movable, line) + "/" + Simple(object, 40);
    }
    diagnostics_.Error({file_, line},
                       "<score> names '" + Printable(name) + "', which is no movable, thing or light" +
                           MeantOf(name, std::views::keys(called_), std::identity(), diagnostics_));
    return name;
  }

  const std::string& file_;
  const std::string& prefix_;
  Diagnostics& diagnostics_;
  Translation out_;
  MadeText random_;
  int robots_ = 0, scores_ = 0;
  std::map<std::string, std::string> called_;      // scenario names of movables, things and lights
  std::map<std::string, const Movable*> written_;  // movables written as robots, by name
  bool is_full_ = false;                           // too many models
  Names names_{"simulation", "world", "swarm", "playback", "recorder", "clock"};
};

}  // namespace

Translation WriteScenario(const Experiment& experiment, const std::string& file, const std::string& prefix,
                          Diagnostics& diagnostics) {
  return ScenarioWriter(file, prefix, diagnostics).Write(experiment);
}

}  // namespace coopdyn::rosiml
