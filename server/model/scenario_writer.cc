// SPDX-License-Identifier: MIT
#include "server/model/scenario_writer.h"

#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <sstream>
#include <vector>

#include "server/model/values.h"

namespace coopdyn {

namespace {

class Lines {
 public:
  explicit Lines(const std::string& section) : text_("[" + section + "]\n") {}

  void Add(const std::string& key, const std::string& value) { text_ += key + " " + value + "\n"; }
  void Add(const std::string& key, std::initializer_list<double> values) {
    text_ += key;
    for (const double value : values) text_ += " " + ExactNumber(value);
    text_ += "\n";
  }
  void Add(const std::string& key, const Color& color) { Add(key, {color.r, color.g, color.b}); }
  void AddPose(const Pose& X) {
    Add("position", {X.p.x(), X.p.y(), X.p.z()});
    const Quaternion& q = X.q;
    if (q.coeffs() == Quaternion::Identity().coeffs()) return;
    const double yaw_rad = Heading(q);
    if (FromRollPitchYaw(0, 0, yaw_rad).coeffs() == q.coeffs()) return Add("orientation", {yaw_rad});
    Add("quaternion", {q.w(), q.x(), q.y(), q.z()});
  }
  void AddTexture(const Texture& texture) {
    if (texture.name.empty()) return;
    Add("texture", texture.name);
    Add("texture_size", {texture.width_m, texture.height_m});
  }
  void AddWatchdog(const std::optional<double>& watchdog_s) {
    if (!watchdog_s) return;
    if (*watchdog_s > 0) return Add("watchdog", {*watchdog_s});
    Add("watchdog", "off");
  }
  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace

std::string ExactNumber(double value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end};
}

std::string WriteFloor(const Floor& floor) {
  Lines lines("FLOOR");
  lines.Add("size", {floor.length_m, floor.width_m, floor.height_m});
  lines.Add("color", floor.color);
  lines.Add("friction", {floor.friction});
  lines.AddTexture(floor.texture);
  return lines.Take();
}

std::string WriteObject(const WorldObject& object) {
  Lines lines(object.name);
  if (const auto* box = std::get_if<Box>(&object.shape)) {
    lines.Add("type", "box");
    lines.Add("size", {box->size_m.x(), box->size_m.y(), box->size_m.z()});
  } else if (const auto* cylinder = std::get_if<Cylinder>(&object.shape)) {
    lines.Add("type", "cylinder");
    lines.Add("size", {2 * cylinder->radius_m, 2 * cylinder->radius_m, cylinder->length_m});
  } else if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
    lines.Add("type", "sphere");
    lines.Add("size", {2 * sphere->radius_m});
  }
  lines.AddPose(object.X_WO);
  if (!object.is_static()) lines.Add("mass", {object.mass_kg});
  lines.Add("color", object.color);
  if (object.friction != WorldObject().friction) lines.Add("friction", {object.friction});
  if (object.restitution > 0) lines.Add("bounce", {object.restitution});
  // For shapes that can roll, write 0, too: it is not the default.
  const bool rolls = !object.is_static() && !std::holds_alternative<Box>(object.shape);
  if (rolls || object.rolling_friction_m > 0) lines.Add("rolling_friction", {object.rolling_friction_m});
  const auto add = [&lines](const char* key, const Vector3& v) {
    if (!v.isZero()) lines.Add(key, {v.x(), v.y(), v.z()});
  };
  if (!object.is_static()) add("velocity", object.v_WO);
  if (!object.is_static()) add("turn_rate", object.w_WO);
  lines.AddTexture(object.texture);
  return lines.Take();
}

std::string WriteLight(const PointLight& light) {
  Lines lines(light.name);
  lines.Add("position", {light.p_WP.x(), light.p_WP.y(), light.p_WP.z()});
  lines.Add("color", light.color);
  lines.Add("power", {light.power});
  if (!light.casts_shadows) lines.Add("shadows", "no");
  return lines.Take();
}

/// The value of the keys `controller` and `supervisor`.
std::string LineOf(const ControllerChoice& controller) {
  std::string line = controller.name;
  for (const auto& [name, value] : controller.options) line += " " + name + "=" + ExactNumber(value);
  return line;
}

std::string WriteRobot(const RobotEntry& robot, std::size_t number, const std::string& type) {
  Lines lines("ROBOT_" + std::to_string(number));
  lines.Add("type", type.find_first_of(" ;#") == std::string::npos ? type : "\"" + type + "\"");
  lines.Add("name", robot.name);
  lines.AddPose(robot.X_WR);
  lines.Add("color", robot.color);
  if (robot.fidelity != Fidelity::kFull) lines.Add("fidelity", ToString(robot.fidelity));
  if (!robot.controller.empty()) {
    lines.Add("controller", LineOf(robot.controller));
  } else if (!robot.sync) {
    lines.Add("sync", "no");
  }
  if (!robot.waits_for.empty()) {
    std::string modules;
    for (const std::string& module : robot.waits_for) modules += (modules.empty() ? "" : " ") + module;
    lines.Add("waits_for", modules);
  }
  if (robot.deadline_s) {
    lines.Add("deadline", {*robot.deadline_s});
    lines.Add("on_deadline", ToString(robot.on_deadline));
  }
  if (robot.on_disconnect) lines.Add("on_disconnect", ToString(*robot.on_disconnect));
  if (!robot.sockets) lines.Add("sockets", "no");
  lines.AddWatchdog(robot.watchdog_s);
  return lines.Take();
}

std::string WriteTargets(std::span<const Target> targets) {
  if (targets.empty()) return {};
  Lines lines("TARGET");
  for (const Target& target : targets) {
    lines.Add(target.color_name, {target.p_WT.x(), target.p_WT.y(), target.p_WT.z()});
  }
  return lines.Take();
}

std::string WriteTask(const Task& task) {
  if (task.empty()) return {};
  Lines lines("TASK");
  const auto add = [&](const char* key, const std::vector<std::string>& values) {
    for (const std::string& value : values) lines.Add(key, value);
  };
  if (!task.title.empty()) lines.Add("title", task.title);
  std::istringstream text(task.text);
  for (std::string line; std::getline(text, line);) {
    if (!line.empty()) lines.Add("text", line);
  }
  add("hint", task.hints);
  add("counts", task.counts);
  return lines.Take();
}

std::string WriteView(const View& view) {
  if (!view.look_W && view.from == View::From::kWhole) return {};
  Lines lines("VIEW");
  if (view.look_W) {
    lines.Add("eye", {view.eye_W.x(), view.eye_W.y(), view.eye_W.z()});
    lines.Add("look", {view.look_W->x(), view.look_W->y(), view.look_W->z()});
  } else {
    lines.Add("from", View::kWords[static_cast<std::size_t>(view.from)]);
  }
  return lines.Take();
}

std::string WriteSimulation(const SimulationOptions& simulation, double ambient_light) {
  Lines lines("SIMULATION");
  if (simulation.mode) lines.Add("mode", ToString(*simulation.mode));
  if (simulation.step) lines.Add("step", {ToSeconds(*simulation.step)});
  if (simulation.substeps) lines.Add("substeps", std::to_string(*simulation.substeps));
  lines.Add("seed", std::to_string(simulation.seed));
  if (simulation.speed) lines.Add("speed", {*simulation.speed});
  if (simulation.duration_s) lines.Add("duration", {*simulation.duration_s});
  lines.AddWatchdog(simulation.watchdog_s);
  const Vector3& g_W = simulation.g_W;
  if (g_W.x() == 0 && g_W.y() == 0) {
    lines.Add("gravity", {0 - g_W.z()});
  } else {
    lines.Add("gravity", {g_W.x(), g_W.y(), g_W.z()});
  }
  if (simulation.overlaps) lines.Add("overlaps", "yes");
  if (ambient_light > 0) lines.Add("ambient_light", {ambient_light});
  if (!simulation.waits_for.empty()) {
    std::string programs = "yarp";
    for (const std::string& program : simulation.waits_for) programs += " " + program;
    lines.Add("waits_for", programs);
  }
  if (!simulation.supervisor.empty()) lines.Add("supervisor", LineOf(simulation.supervisor));
  return lines.Take();
}

}  // namespace coopdyn
