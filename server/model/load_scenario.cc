// SPDX-License-Identifier: MIT
// Finds a scenario's file by name and reads it according to its kind: scenario, world, SDF world, robot or
// experiment.
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "server/model/experiment.h"
#include "server/model/readers.h"
#include "server/model/sdf_world.h"
#include "server/model/section_reader.h"
#include "server/model/settings.h"
#include "server/model/swarm.h"
#include "server/model/text_file.h"
#include "server/model/textures.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

bool IsUrdf(const std::filesystem::path& file) {
  const std::string extension = ToLower(file.extension().string());
  return extension == ".urdf" || extension == ".xacro";
}

/// The text of a scenario with only the robot of a URDF file.
std::string UrdfAsScenario(const std::filesystem::path& file) {
  return "[WORLD]\nfile empty.world\n\n[ROBOT_1]\ntype ./" + file.filename().string() + "\nposition 0 0\n";
}

/// `scenario` with the lines of the SDF world from which it was made.
std::shared_ptr<const Scenario> AsWritten(const Scenario& scenario,
                                          const std::map<std::string, SourceLine>& places) {
  auto placed = std::make_shared<Scenario>(scenario);
  const auto place = [&](auto& all) {
    for (auto& one : all) {
      if (const auto found = places.find(one.name); found != places.end()) one.where = found->second;
    }
  };
  place(placed->objects);
  place(placed->robots);
  return placed;
}

/// Reads a .world as a scenario without robots.
std::shared_ptr<const Scenario> WorldAsScenario(const std::string& text, const std::string& file,
                                                const RobotLibrary& library,
                                                std::optional<std::uint64_t> seed, Diagnostics& diagnostics) {
  auto scenario = std::make_shared<Scenario>();
  Textures textures(library, file, "", true);
  const WorldModel world = ReadWorld(text, file, diagnostics, &textures);
  scenario->name = std::filesystem::path(file).stem().string();
  scenario->file = file;
  scenario->text = world.text;
  scenario->floor = world.floor.value_or(Floor());
  scenario->objects = world.objects;
  scenario->lights = world.lights;
  scenario->ambient_light = world.ambient_light.value_or(0);
  scenario->sources = textures.sources();
  if (seed) scenario->simulation.seed = *seed;
  AddScattered(world.scattered, {}, *scenario, diagnostics);
  return diagnostics.has_errors() ? nullptr : scenario;
}

}  // namespace

std::shared_ptr<const Scenario> LoadScenario(const std::string& name, RobotLibrary& robots,
                                             Diagnostics& diagnostics, bool by_socket,
                                             std::optional<std::uint64_t> seed, const Settings& settings) {
  if (by_socket && !IsBareName(name)) {
    diagnostics.Error({name, 0},
                      "over a socket a scenario is named by its bare name on the search path, for "
                      "example: corridor");
    return nullptr;
  }
  const auto path = robots.path().FindScenario(name);
  if (!path) {
    std::error_code error;
    if (std::filesystem::is_regular_file(name, error)) {
      const bool run = std::filesystem::path(name).extension() == ".run";
      diagnostics.Error({name, 0},
                        run ? std::string("this is a recorded run: coopdyn play and coopdyn info read it")
                            : "write ./" + name + " to read that file as a scenario");
    } else {
      const std::vector<std::string> names = robots.path().ScenarioNames();
      diagnostics.Error({name, 0}, "there is no such scenario" + DidYouMean(name, names));
    }
    return nullptr;
  }
  const std::string file = path->string();
  Diagnostics found;
  std::optional<std::string> text = ReadTextFile(file, {file, 0}, found);
  std::shared_ptr<const Scenario> scenario;
  if (text && IsExperiment(*text, file)) {
    scenario = ReadScenario(WithSettings(*text, settings, found), file, robots, false, found, seed);
  } else if (text && IsUrdf(*path)) {
    scenario =
        ReadScenario(WithSettings(UrdfAsScenario(*path), settings, found), file, robots, false, found, seed);
  } else if (text && IsXml(*text)) {  // Gazebo's worlds may end in .world, too
    if (const std::optional<SdfWorld> world = ReadSdfWorld(file, robots.path(), found)) {
      for (const auto& [name, model] : world->models) robots.Add(model->type, model);
      scenario =
          ReadScenario(WithSettings(world->scenario, settings, found), file, robots, false, found, seed);
      if (scenario != nullptr) scenario = AsWritten(*scenario, world->places);
    }
  } else if (text && ToLower(path->extension().string()) == ".world") {
    if (!settings.empty()) {
      found.Error({"--set " + settings.front(), 0},
                  name + " is a world, and settings are for scenarios: write one with [WORLD] and file " +
                      path->filename().string());
    }
    scenario = WorldAsScenario(*text, file, robots, seed, found);
  } else if (text) {
    scenario = ReadScenario(WithSettings(*text, settings, found), file, robots, false, found, seed);
  }
  diagnostics.Append(found);
  return found.has_errors() ? nullptr : scenario;
}

}  // namespace coopdyn
