// SPDX-License-Identifier: MIT
#include <boost/json.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "protocol/json_text.h"
#include "server/app/checker.h"
#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/print.h"
#include "server/app/run_report.h"
#include "server/render/picture_maker.h"

namespace coopdyn {

namespace {

struct CheckOptions {
  std::vector<std::string> files;
  std::string picture;
  std::vector<std::string> scenario_folders;
  Settings settings;
  bool digests = false;
};

int Check(const CheckOptions& options) {
  const SearchPath path = DataPath(options.scenario_folders);
  RobotLibrary robots(path);
  bool failed = false;
  FramePtr last;
  for (const std::string& file : options.files) {
    Diagnostics diagnostics;
    Checked checked = CheckFile(file, robots, diagnostics, true, options.settings);
    if (options.digests && checked.frame != nullptr && !diagnostics.has_errors()) {
      Print("{}\n", JsonText(boost::json::value_from(DigestsNow(*checked.frame))));
      checked.lines.clear();
    }
    for (std::size_t i = 0; i < checked.lines.size(); ++i) {
      Print("{}{}\n", i == 0 ? file + ": " : "", checked.lines[i]);
    }
    if (checked.frame != nullptr) last = std::move(checked.frame);
    PrintErrorLines(diagnostics.ToString());
    failed = failed || diagnostics.has_errors();
  }
  if (!options.picture.empty() && !failed) {
    if (last == nullptr) {
      PrintError("coopdyn: --picture needs a scenario, a world or a robot model\n");
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
  sub->add_option("--picture", given->picture, "Write a picture of the (last) scenario or model, PNG");
  sub->add_flag("--digests", given->digests,
                "Instead of what is in a scenario: digests of the program and of all that the scenario is "
                "made of, JSON");
  AddSettings(sub, given->settings);
  sub->add_option("--scenarios", given->scenario_folders, "A folder with scenarios, worlds and robots");
  sub->callback([&chosen, given] { chosen = [given] { return Check(*given); }; });
}

}  // namespace coopdyn
