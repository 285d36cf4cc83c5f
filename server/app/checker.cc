// SPDX-License-Identifier: MIT
#include "server/app/checker.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>

#include <spdlog/fmt/fmt.h>

#include "server/app/model_text.h"
#include "server/base/log.h"
#include "server/base/worker_pool.h"
#include "server/controllers/controller_host.h"
#include "server/model/scenario.h"
#include "server/model/sdf_world.h"
#include "server/model/text_file.h"
#include "server/physics/world.h"

namespace coopdyn {

namespace {

/// Reports options that the controllers of `scenario` reject, and robots of `frame` that they cannot drive.
/// `frame` may be null.
void CheckControllers(const Scenario& scenario, const FramePtr& frame, Diagnostics& diagnostics) {
  const SteadyClock clock;
  WorkerPool pool(1);
  ControllerHost host(ControllerOptions{}, clock, NullLogger(), pool);
  host.Check(scenario, diagnostics);
  if (frame == nullptr || diagnostics.has_errors()) return;
  host.Configure(frame);
  std::set<std::string> said;
  for (const StoppedController& stopped : host.TakeStopped()) {
    const auto robot = std::ranges::find(scenario.robots, stopped.robot, &RobotEntry::name);
    const bool known = diagnostics.ToString().find(stopped.why) != std::string::npos;
    if (robot == scenario.robots.end() || known || !said.insert(stopped.why).second) continue;
    diagnostics.Warning(robot->controller.where, stopped.why + "; " + stopped.robot + " will stand");
  }
}

/// The first frame of `scenario`; null with diagnostics if its physics cannot be built.
FramePtr FirstFrame(const std::shared_ptr<const Scenario>& scenario, bool controllers,
                    Diagnostics& diagnostics) {
  auto frame = std::make_shared<Frame>();
  frame->scene = MakeScene(scenario);
  frame->seed = scenario->simulation.seed;
  const auto world = PhysicsWorld::Build(frame->scene, frame->seed, diagnostics);
  if (world != nullptr) world->Fill(*frame);
  if (controllers) CheckControllers(*scenario, world == nullptr ? nullptr : frame, diagnostics);
  return world == nullptr ? nullptr : frame;
}

/// True for a single model; false for a world or several models.
bool IsRobotModel(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension();
  if (extension == ".urdf" || extension == ".xacro") return true;
  if (extension != ".sdf") return false;
  Diagnostics ignored;
  const auto text = ReadTextFile(file, {file, 0}, ignored);
  return !text || IsOneSdfModel(*text);
}

constexpr const char* kAlone = "model";

Checked CheckModel(const std::string& file, RobotLibrary& robots, Diagnostics& diagnostics) {
  const auto model = ReadRobotModel(file, robots.path(), diagnostics);
  if (model == nullptr || diagnostics.has_errors()) return {};
  // The picture shows the model alone on a floor.
  RobotLibrary own(robots.path());
  own.Add(kAlone, model);
  const auto alone =
      ReadScenario("[ROBOT_1]\ntype " + std::string(kAlone) + "\nposition 0 0\n", "", own, true, diagnostics);
  return {alone == nullptr ? nullptr : FirstFrame(alone, false, diagnostics), {SummaryOf(*model)}, model};
}

/// Reads the file with this seed, or with its own.
using ReadWithSeed = std::function<std::shared_ptr<const Scenario>(std::optional<std::uint64_t> seed,
                                                                   Diagnostics& diagnostics)>;
/// Number of seeds to try: a rarely drawn value may be invalid.
constexpr std::uint64_t kTriedSeeds = 32;

/// Warns of the first seed that draws an invalid value.
void CheckOtherSeeds(const Scenario& scenario, const ReadWithSeed& read, Diagnostics& diagnostics) {
  if (scenario.random.empty() || diagnostics.has_errors()) return;
  for (std::uint64_t seed = 1; seed <= kTriedSeeds; ++seed) {
    Diagnostics of_seed;
    if (read(seed, of_seed) != nullptr) continue;
    for (const Diagnostic& one : of_seed.all()) {
      if (one.level == Diagnostic::Level::kError)
        diagnostics.Warning(one.where, fmt::format("with seed {}: {}", seed, one.text));
    }
    return;
  }
}

Checked CheckScenario(const std::shared_ptr<const Scenario>& scenario, bool controllers,
                      Diagnostics& diagnostics) {
  if (scenario == nullptr) return {};
  Checked checked{FirstFrame(scenario, controllers, diagnostics), {}, nullptr};
  if (checked.frame != nullptr && !diagnostics.has_errors()) checked.lines.push_back(Summary(*scenario));
  for (std::size_t i = 0; i < scenario->random.size() && !checked.lines.empty(); ++i) {
    const RandomKey& key = scenario->random[i];
    checked.lines.push_back("  " + key.name + " " + key.distribution + ": " + key.value + " for seed " +
                            std::to_string(scenario->simulation.seed));
  }
  return checked;
}

Checked CheckSeeds(const ReadWithSeed& read, bool controllers, Diagnostics& diagnostics) {
  const std::shared_ptr<const Scenario> scenario = read(std::nullopt, diagnostics);
  if (scenario != nullptr) CheckOtherSeeds(*scenario, read, diagnostics);
  return CheckScenario(scenario, controllers, diagnostics);
}

}  // namespace

Checked CheckFile(const std::string& file, RobotLibrary& robots, Diagnostics& diagnostics, bool controllers,
                  const Settings& settings) {
  if (IsRobotModel(file)) return CheckModel(file, robots, diagnostics);
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    diagnostics.Error({file, 0}, "it is a folder: name the files to check, for example " +
                                     (std::filesystem::path(file) / "*.scenario").string());
    return {};
  }
  if (!IsPipe(file)) {
    return CheckSeeds(
        [&](std::optional<std::uint64_t> seed, Diagnostics& found) {
          return LoadScenario(file, robots, found, false, seed, settings);
        },
        controllers, diagnostics);
  }
  std::optional<std::string> text = ReadPipe(file, diagnostics);
  if (text) text = WithSettings(std::move(*text), settings, diagnostics);
  if (!text || diagnostics.has_errors()) return {};
  return CheckSeeds(
      [&](std::optional<std::uint64_t> seed, Diagnostics& found) {
        return ReadScenario(*text, kPipe, robots, false, found, seed);
      },
      controllers, diagnostics);
}

Checked CheckScenarioText(const std::string& text, const std::string& name, RobotLibrary& robots,
                          Diagnostics& diagnostics) {
  return CheckSeeds([&](std::optional<std::uint64_t> seed,
                        Diagnostics& found) { return ReadScenario(text, name, robots, true, found, seed); },
                    true, diagnostics);
}

}  // namespace coopdyn
