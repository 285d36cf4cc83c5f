// SPDX-License-Identifier: MIT
// coopdyn check: says everything that is wrong in worlds, scenarios and robot models, physics included.
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "server/app/commands.h"
#include "server/controllers/controller_host.h"
#include "server/model/readers.h"
#include "server/model/summary.h"
#include "server/physics/world.h"
#include "server/render/picture_maker.h"

namespace coopdyn {

namespace {

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
      std::printf("%s: robot %s, %zu links, %zu joints, %zu distance sensors, %zu modules\n", file.c_str(),
                  model->type.c_str(), model->links.size(), model->joints.size(),
                  model->distance_sensors.size(), model->modules.size());
    }
    return nullptr;
  }
  const auto scenario = LoadScenario(file, robots, diagnostics);
  if (scenario == nullptr) return nullptr;
  FramePtr frame = FirstFrame(scenario, diagnostics);
  if (frame != nullptr && !diagnostics.has_errors())
    std::printf("%s: %s\n", file.c_str(), Summary(*scenario).c_str());
  return frame;
}

}  // namespace

int Check(const CheckOptions& options) {
  SearchPath path;
  for (const std::string& folder : DataFolders(options.scenario_folders)) path.folders.emplace_back(folder);
  RobotLibrary robots(path);
  Diagnostics all;
  FramePtr last;
  for (const std::string& file : options.files) {
    Diagnostics diagnostics;
    if (FramePtr frame = CheckFile(file, robots, diagnostics)) last = std::move(frame);
    all.Append(diagnostics);
  }
  std::cerr << all.ToString();
  if (!options.picture.empty() && !all.has_errors()) {
    if (last == nullptr) {
      std::cerr << "coopdyn: --picture needs a .scenario or .world, a robot model alone is not drawn\n";
      return kExitWrongUse;
    }
    std::string unusable;
    const RendererKind renderer = RendererFromEnvironment(RendererKind::kAuto, unusable);
    ImageRequest request;
    request.width = 1280;
    request.height = 720;
    const auto error = unusable.empty() ? RenderPicture(*last, request, renderer, options.picture) : unusable;
    if (error) {
      std::cerr << "coopdyn: " << *error << '\n';
      return kExitErrors;
    }
  }
  return all.has_errors() ? kExitErrors : kExitOk;
}

}  // namespace coopdyn
