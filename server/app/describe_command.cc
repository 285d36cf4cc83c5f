// SPDX-License-Identifier: MIT
#include <tinyxml2.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <numeric>
#include <set>
#include <sstream>
#include <system_error>

#include "protocol/command_ids.h"
#include "protocol/common_commands.h"
#include "protocol/module_tables.h"
#include "protocol/usage.h"
#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/print.h"
#include "server/model/readers.h"
#include "server/model/scenario.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// The type of a robot, with a link to its page if it has one: robots of an experiment do not.
std::string LinkTo(const RobotModel& model) {
  if (model.file.ends_with(".xml")) return model.type;
  return "[" + model.type + "](../robots/" + model.type + ".md)";
}

using tinyxml2::XMLElement;
namespace fs = std::filesystem;

/// A row of a table in Markdown.
std::string TableRow(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += " " + cell + " |";
  return row + "\n";
}

std::string TableHead(const std::vector<std::string>& names) {
  return "\n" + TableRow(names) + TableRow(std::vector<std::string>(names.size(), "---"));
}

std::string CodeSpan(const std::string& text) {
  return "`" + text + "`";
}

/// At most five significant digits, so that pages show the files' values, not rounding errors.
std::string ShortNumber(double value) {
  return fmt::format("{:.5g}", value + 0.0);
}

std::string Degrees(double angle_rad) {
  return ShortNumber(std::round(angle_rad * 180 / std::numbers::pi * 1e3) / 1e3);
}

std::string PositionText(const Vector3& p) {
  return ShortNumber(p.x()) + " " + ShortNumber(p.y()) + " " + ShortNumber(p.z());
}

/// The leading comment of a file. Indented lines are commands.
std::string LeadingComment(const std::string& text) {
  std::string comment;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line) && line.starts_with("#");) {
    const std::string rest = line.substr(std::min<std::size_t>(line.size(), 2));
    comment += rest.starts_with("  ") ? "\n    " + std::string(Trim(rest)) + "\n" : rest + "\n";
  }
  return comment;
}

// Modules.

bool IsGlobal(const CommandTable& table) {
  for (const char* name : {"simulation", "world", "swarm", "recorder", "playback"}) {
    if (table.module() == name) return true;
  }
  return false;
}

/// The commands of a module without those that every module has.
std::vector<CommandSpec> OwnCommands(const CommandTable& table) {
  std::vector<CommandSpec> own;
  const std::vector<CommandSpec> common = CommonCommands({});
  for (const CommandSpec& spec : table.commands()) {
    const auto id = static_cast<std::size_t>(spec.id);
    if (id >= common.size() || Usage(spec) != Usage(common[id])) own.push_back(spec);
  }
  return own;
}

std::string TextOf(const CommandSpec& spec) {
  if (spec.text == TextUse::kNone) return "–";
  if (spec.text == TextUse::kOrNumber) return "or " + spec.text_name;
  return spec.text_optional || spec.text == TextUse::kFirst ? "[" + spec.text_name + "]" : spec.text_name;
}

std::string ModulePage(const CommandTable& table) {
  const std::string socket = (IsGlobal(table) ? "/" : "/ROBOT/") + table.module();
  std::string page = "# Module " + table.module() + "\n\nIts socket is " + CodeSpan(socket) +
                     ". Values in `[ ]` may be left out; `…` means any number of them. Each reply ends with "
                     "`time_s` and `step`.\n";
  std::string readings;
  for (const CommandSpec& spec : OwnCommands(table)) {
    page += "\n## " + spec.name + "\n\n" + spec.help + "\n\n    " + Usage(spec) + "\n";
    page += TableHead({"command " + std::to_string(spec.id), "text", "params", "data"});
    page += TableRow({"request", TextOf(spec), ValuesCell(spec.params, true), ValuesCell(spec.data, true)});
    page += TableRow({"reply", spec.reply_text.empty() ? "–" : spec.reply_text, ValuesCell(spec.reply_params),
                      ValuesCell(spec.reply_data)});
    page += "\nFor example " + CodeSpan(ExampleLine(spec)) + "\n";
    if (spec.id == command::kGetStatus) {
      page += "\n[protocol.md](../../protocol.md#simulation) lists the fields of its JSON.\n";
    }
    if (IsSubscribable(spec)) readings += (readings.empty() ? "" : ", ") + CodeSpan(spec.name);
  }
  page += "\n## Like every module\n";
  for (const CommandSpec& spec : CommonCommands({})) {
    page += (page.ends_with('\n') ? "\n" : ", ") + CodeSpan(spec.name);
  }
  return page + "\n\n[protocol.md](../../protocol.md#every-module) describes these. `subscribe` here takes " +
         (readings.empty() ? "nothing" : readings) + ".\n";
}

// Robots.

/// `radius 0.18, height 0.15`
std::string Attributes(const XMLElement& element) {
  std::string text;
  for (const auto* one = element.FirstAttribute(); one != nullptr; one = one->Next()) {
    text += std::string(text.empty() ? "" : ", ") + one->Name() + " " + one->Value();
  }
  return text.empty() ? "–" : text;
}

std::string JointRows(const RobotModel& robot) {
  const auto value = [](double number, const char* unit) {
    return std::isfinite(number) && number != 0 ? ShortNumber(number) + " " + unit : std::string("–");
  };
  const auto link = [&robot](int index) { return robot.links[static_cast<std::size_t>(index)].name; };
  std::string rows;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const JointModel& joint = robot.joints[j];
    const auto stop = [&joint](double number) {
      if (!std::isfinite(number)) return std::string("–");
      return joint.slides() ? ShortNumber(number) + " m" : Degrees(number) + "°";
    };
    const CouplingModel* coupling = robot.FindCoupling(static_cast<int>(j));
    rows += TableRow({joint.name, ToString(joint.kind), link(joint.parent), link(joint.child),
                      stop(joint.lower), stop(joint.upper),
                      coupling == nullptr
                          ? value(joint.max_effort, joint.slides() ? "N" : "N m")
                          : "follows " + robot.joints[static_cast<std::size_t>(coupling->leader)].name,
                      value(joint.max_velocity, joint.slides() ? "m/s" : "rad/s")});
  }
  return rows;
}

std::string ModuleRow(const ModuleModel& module) {
  const CommandTable* table = FindModuleTable(module.type);
  if (table == nullptr) return {};
  std::string commands;
  for (const CommandSpec& spec : OwnCommands(*table)) commands += CodeSpan(spec.name) + " ";
  return TableRow({CodeSpan("/ROBOT/" + module.name),
                   "[" + module.type + "](../modules/" + module.type + ".md)", std::string(Trim(commands))});
}

/// Lists the <coopdyn:…> elements of the model. They describe the robot's devices, so new kinds need no code
/// here.
std::string DeviceRows(const XMLElement& model) {
  constexpr std::size_t kPrefix = std::string_view("coopdyn:").size();
  std::string rows;
  for (const auto* device = model.FirstChildElement(); device != nullptr;
       device = device->NextSiblingElement()) {
    const std::string name = device->Name();
    if (!name.starts_with("coopdyn:") || name == "coopdyn:module") continue;
    rows += TableRow({CodeSpan(name.substr(kPrefix)), Attributes(*device)});
    int number = 0;
    for (const auto* part = device->FirstChildElement(); part != nullptr; part = part->NextSiblingElement()) {
      rows += TableRow({CodeSpan(std::string(part->Name()).substr(kPrefix)) + " " + std::to_string(++number),
                        Attributes(*part)});
    }
  }
  return rows;
}

/// `type`: the robot's type in a scenario.
std::string RobotPage(const RobotModel& robot, const std::string& type) {
  const double mass_kg =
      std::accumulate(robot.links.begin(), robot.links.end(), 0.0,
                      [](double sum, const LinkModel& link) { return sum + link.mass_kg; });
  tinyxml2::XMLDocument document;
  document.Parse(robot.text.data(), robot.text.size());
  const XMLElement& model = *document.RootElement()->FirstChildElement("model");

  std::string page = "# Robot " + robot.type + "\n\nIn a scenario:\n\n    [ROBOT_1]\n    type      " + type +
                     "\n    name      robot1\n    position  0 0\n";
  page += TableHead({"body", ""});
  page += TableRow({"mass", ShortNumber(mass_kg) + " kg"});
  page += TableRow({"radius of its footprint", ShortNumber(robot.footprint_radius_m) + " m"});
  page += TableRow({"height", ShortNumber(robot.height_m) + " m"});
  for (const LinkModel& link : robot.links) {
    if (link.is_carrier) continue;
    page += TableRow({"link " + CodeSpan(link.name), ShortNumber(link.mass_kg) + " kg"});
  }
  if (!robot.joints.empty()) {
    page += "\n## Joints\n" +
            TableHead({"joint", "kind", "parent", "child", "from", "to", "effort", "top speed"}) +
            JointRows(robot);
  }
  page += "\n## Modules\n" + TableHead({"socket", "type", "commands"});
  for (const ModuleModel& module : robot.modules()) page += ModuleRow(module);
  const std::string devices = DeviceRows(model);
  if (devices.empty()) return page;
  page +=
      "\n## Drive and sensors\n\nAs the model says it: lengths in m, angles in degrees where the name says "
      "so. "
      "[formats.md](../../formats.md#robots) explains each word.\n";
  return page + TableHead({"element", "attributes"}) + devices;
}

// Scenarios.

std::string ShapeText(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return "box " + PositionText(box->size_m);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    return "cylinder " + ShortNumber(2 * cylinder->radius_m) + " " + ShortNumber(cylinder->length_m);
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return "sphere " + ShortNumber(2 * sphere->radius_m);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    return "capsule " + ShortNumber(2 * capsule->radius_m) + " " + ShortNumber(capsule->length_m);
  }
  return "mesh";
}

std::string ScenarioPage(const Scenario& scenario) {
  constexpr std::size_t kMostRows = 100;
  std::string page = "# Scenario " + scenario.name + "\n\n" + LeadingComment(scenario.text);
  if (!scenario.world.text.empty()) {
    page += "\nThe world, " + fs::path(scenario.world.file).filename().string() + ": " +
            LeadingComment(scenario.world.text);
  }
  page += "\n    coopdyn serve " + scenario.name + "\n\nIn short: " + Summary(scenario) + ".\n";

  page += "\n## Robots\n" + TableHead({"name", "type", "position m", "heading °", "driven by", "fidelity"});
  const auto row = [&page](const std::string& name, const RobotEntry& robot, const std::string& position,
                           const std::string& heading) {
    page += TableRow({name, LinkTo(*robot.model), position, heading,
                      robot.controller.empty() ? "clients" : "controller " + robot.controller.name,
                      ToString(robot.fidelity)});
  };
  std::set<std::size_t> in_swarms;
  for (const SwarmEntry& swarm : scenario.swarms) {
    row(swarm.name + "_1 … " + swarm.name + "_" + std::to_string(swarm.count), scenario.robots[swarm.first],
        "by seed", "by seed");
    for (std::size_t i = 0; i < swarm.count; ++i) in_swarms.insert(swarm.first + i);
  }
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const RobotEntry& robot = scenario.robots[i];
    if (!in_swarms.contains(i))
      row(robot.name, robot, PositionText(robot.X_WR.p), Degrees(Heading(robot.X_WR.q)));
  }
  if (!scenario.targets.empty()) {
    page += "\n## Targets\n" + TableHead({"id", "colour", "position m"});
    for (const Target& target : scenario.targets) {
      page += TableRow({std::to_string(target.id.value), target.color_name, PositionText(target.p_WT)});
    }
  }
  if (!scenario.objects.empty()) {
    page += "\n## Things\n" + TableHead({"name", "shape and size m", "centre m", "heading °", "mass"});
  }
  for (std::size_t i = 0; i < std::min(kMostRows, scenario.objects.size()); ++i) {
    const WorldObject& object = scenario.objects[i];
    page += TableRow({object.name, ShapeText(object.shape), PositionText(object.X_WO.p),
                      Degrees(Heading(object.X_WO.q)),
                      object.is_static() ? "never moves" : ShortNumber(object.mass_kg) + " kg"});
  }
  if (scenario.objects.size() > kMostRows) {
    page += "\nand " + std::to_string(scenario.objects.size() - kMostRows) + " more\n";
  }
  return page;
}

// The command.

/// The page to print.
struct Wanted {
  std::string kind, name;
  std::vector<std::string> scenario_folders;
};

std::vector<std::string> RobotNames(const SearchPath& path) {
  std::set<std::string> names;
  for (const fs::path& folder : path.folders) {
    std::error_code error;
    for (fs::directory_iterator it(folder / "robots", error), end; !error && it != end; it.increment(error)) {
      if (fs::is_regular_file(it->path() / "model.sdf", error)) names.insert(it->path().filename().string());
    }
  }
  return {names.begin(), names.end()};
}

std::vector<std::string> ModuleNames() {
  std::vector<std::string> names;
  for (const CommandTable& table : AllModuleTables()) names.push_back(table.module());
  return names;
}

std::vector<std::string> PageNames(const std::string& kind, const SearchPath& path) {
  if (kind == "robot") return RobotNames(path);
  return kind == "module" ? ModuleNames() : path.ScenarioNames();
}

/// A list of all pages with their links in docs/reference.
std::string Index(const SearchPath& path) {
  std::string page = "# Reference\n\nWhat `coopdyn describe KIND NAME` prints.\n";
  for (const char* kind : {"robot", "module", "scenario"}) {
    page += "\n## " + std::string(kind) + "s\n\n";
    for (const std::string& name : PageNames(kind, path)) {
      page += "- [" + name + "](" + kind + "s/" + name + ".md)\n";
    }
  }
  return page;
}

/// The page; empty with `diagnostics` if it does not exist.
std::string Page(const Wanted& wanted, const SearchPath& path, Diagnostics& diagnostics) {
  RobotLibrary robots(path);
  if (wanted.kind == "robot") {
    std::error_code error;
    const auto robot = fs::is_regular_file(wanted.name, error)
                           ? ReadRobotModel(wanted.name, path, diagnostics)
                           : robots.Get(wanted.name, {"coopdyn describe", 0}, diagnostics);
    return robot == nullptr ? "" : RobotPage(*robot, wanted.name);
  }
  if (wanted.kind == "scenario") {
    const auto scenario = LoadScenario(wanted.name, robots, diagnostics);
    return scenario == nullptr ? "" : ScenarioPage(*scenario);
  }
  const std::string type = wanted.name.substr(wanted.name.rfind('/') + 1);  // also from /robot1/compass
  if (const CommandTable* table = FindModuleTable(type)) return ModulePage(*table);
  diagnostics.Error({"coopdyn describe", 0},
                    "there is no module '" + type + "'" + DidYouMean(type, ModuleNames()));
  return {};
}

int Describe(const Wanted& wanted) {
  const SearchPath path = DataPath(wanted.scenario_folders);
  if (wanted.kind.empty()) {
    PrintLines(Index(path));
    return kExitOk;
  }
  if (wanted.name.empty()) {
    PrintError("coopdyn: describe {} takes a name, one of {}\n", wanted.kind,
               JoinNames(PageNames(wanted.kind, path)));
    return kExitWrongUse;
  }
  Diagnostics diagnostics;
  const std::string page = Page(wanted, path, diagnostics);
  PrintErrorLines(diagnostics.ToString());
  PrintLines(page);
  return page.empty() ? kExitErrors : kExitOk;
}

}  // namespace

void AddDescribe(CLI::App& app, Chosen& chosen) {
  const auto wanted = std::make_shared<Wanted>();
  CLI::App* sub = app.add_subcommand("describe", "Print a page about a robot, a module or a scenario");
  sub->footer(
      "Prints Markdown; without words, a list of all pages.\n"
      "Examples: coopdyn describe robot minibot\n"
      "          coopdyn describe module motors\n"
      "          coopdyn describe scenario formation");
  sub->add_option("kind", wanted->kind, "robot, module or scenario")
      ->check(OneOf({"robot", "module", "scenario"}));
  sub->add_option("name", wanted->name, "Which one");
  sub->add_option("--scenarios", wanted->scenario_folders, "A folder with scenarios, worlds and robots");
  sub->callback([&chosen, wanted] { chosen = [wanted] { return Describe(*wanted); }; });
}

}  // namespace coopdyn
