// SPDX-License-Identifier: MIT
#include <filesystem>
#include <memory>
#include <vector>

#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/print.h"
#include "server/controllers/controller_host.h"
#include "server/model/readers.h"
#include "server/model/scenario.h"
#include "server/model/text_file.h"
#include "server/physics/world.h"
#include "server/render/picture_maker.h"

namespace coopdyn {

namespace {

struct CheckOptions {
  std::vector<std::string> files;
  std::string picture;
  std::vector<std::string> scenario_folders;
};

/// Says what the controllers that `scenario` names do not take.
void CheckControllers(const Scenario& scenario, Diagnostics& diagnostics) {
  const SteadyClock clock;
  WorkerPool pool(1);
  ControllerHost(ControllerOptions{}, clock, NullLogger(), pool).Check(scenario, diagnostics);
}

/// The first frame of `scenario`; null with diagnostics if its physics cannot be built.
FramePtr FirstFrame(const std::shared_ptr<const Scenario>& scenario, Diagnostics& diagnostics) {
  auto frame = std::make_shared<Frame>();
  frame->scene = MakeScene(scenario);
  frame->seed = scenario->simulation.seed;
  const auto world = PhysicsWorld::Build(frame->scene, frame->seed, diagnostics);
  CheckControllers(*scenario, diagnostics);
  if (world == nullptr) return nullptr;
  world->Fill(*frame);
  return frame;
}

bool IsRobotModel(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension();
  return extension == ".sdf" || extension == ".urdf";
}

/// Checks one file; null, or its first frame for a picture.
FramePtr CheckFile(const std::string& file, RobotLibrary& robots, Diagnostics& diagnostics) {
  if (IsRobotModel(file)) {
    const auto model = ReadRobotModel(file, diagnostics);
    if (model != nullptr) {
      Print("{}: robot {}, {} links, {} joints, {} distance sensors, {} modules\n", file, model->type,
            model->links.size(), model->joints.size(), model->sector_count(), model->modules().size());
    }
    return nullptr;
  }
  std::shared_ptr<const Scenario> scenario;
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    diagnostics.Error({file, 0}, "it is a folder: name the files to check, for example " +
                                     (std::filesystem::path(file) / "*.scenario").string());
    return nullptr;
  }
  if (IsPipe(file)) {
    const std::optional<std::string> text = ReadPipe(file, diagnostics);
    if (text) scenario = ReadScenario(*text, kPipe, robots, false, diagnostics);
  } else {
    scenario = LoadScenario(file, robots, diagnostics);
  }
  if (scenario == nullptr) return nullptr;
  FramePtr frame = FirstFrame(scenario, diagnostics);
  if (frame != nullptr && !diagnostics.has_errors()) Print("{}: {}\n", file, Summary(*scenario));
  return frame;
}

int Check(const CheckOptions& options) {
  const SearchPath path = DataPath(options.scenario_folders);
  RobotLibrary robots(path);
  bool failed = false;
  FramePtr last;
  for (const std::string& file : options.files) {
    Diagnostics diagnostics;
    if (FramePtr frame = CheckFile(file, robots, diagnostics)) last = std::move(frame);
    PrintErrorLines(diagnostics.ToString());
    failed = failed || diagnostics.has_errors();
  }
  if (!options.picture.empty() && !failed) {
    if (last == nullptr) {
      PrintError("coopdyn: --picture needs a .scenario or .world, a robot model alone is not drawn\n");
      return kExitWrongUse;
    }
    std::string unusable;
    const RendererKind renderer = RendererFromEnvironment(RendererKind::kAuto, unusable);
    ImageRequest request;
    request.width = 1280;
    request.height = 720;
    const auto error = unusable.empty() ? RenderPicture(*last, request, renderer, options.picture) : unusable;
    if (error) {
      PrintError("coopdyn: {}\n", *error);
      return kExitErrors;
    }
  }
  return failed ? kExitErrors : kExitOk;
}

}  // namespace

void AddCheck(CLI::App& app, Chosen& chosen) {
  const auto given = std::make_shared<CheckOptions>();
  CLI::App* sub = app.add_subcommand("check", "Say what is wrong in worlds, scenarios and robot models");
  sub->footer("Example: coopdyn check my.scenario --picture my.png");
  sub->add_option("file", given->files, "Files, or bare names on the search path")->required();
  sub->add_option("--picture", given->picture, "Write a picture of the (last) scenario, PNG");
  sub->add_option("--scenarios", given->scenario_folders, "A folder with scenarios, worlds and robots");
  sub->callback([&chosen, given] { chosen = [given] { return Check(*given); }; });
}

}  // namespace coopdyn
