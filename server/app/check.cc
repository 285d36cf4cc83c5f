// SPDX-License-Identifier: MIT
#include <boost/json.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "protocol/json_text.h"
#include "server/app/check_report.h"
#include "server/app/commands.h"
#include "server/app/drive_lines.h"
#include "server/app/options.h"
#include "server/app/print.h"
#include "server/app/run_report.h"
#include "server/base/printable.h"
#include "server/model/missing_files.h"
#include "server/render/picture_maker.h"

namespace coopdyn {

namespace {

struct CheckOptions {
  std::vector<std::string> files;
  std::string picture;
  std::string search;
  std::vector<std::string> scenario_folders;
  Settings settings;
  bool digests = false, strict = false, json = false, verbose = false;
};

std::string ScenariosOption(const std::string& folder) {
  return " --scenarios " + ShellWord(folder);
}

/// Searches the folders below `below` for files that `file` names and `path` does not find; prints these
/// folders and adds them to `path`. Repeats, because a found model may name more files. Returns the folders
/// as options of `serve`.
std::string Search(const std::string& file, const std::string& below, SearchPath& path) {
  std::string options;
  std::vector<std::string> missing = MissingUris(file, path);
  const std::size_t count = missing.size();
  while (!missing.empty()) {
    FoundFolders found = FoldersWith(missing, below);
    if (found.folders.empty()) break;
    for (std::filesystem::path& folder : found.folders) {
      options += ScenariosOption(folder.string());
      path.folders.push_back(std::move(folder));
    }
    const std::vector<std::string> before = std::move(missing);
    missing = MissingUris(file, path);
    if (missing == before) break;
  }
  if (count == 0) Print("{}: all files that it names were found\n", file);
  if (!options.empty()) Print("{}: what it names is found with{}\n", file, options);
  for (const std::string& uri : missing) Print("{}: '{}' is nowhere in {}\n", file, Printable(uri), below);
  return options;
}

/// The part of `options` that `serve` needs for a file read with them.
std::string ServeOptionsOf(const CheckOptions& options) {
  std::string words;
  for (const std::string& folder : options.scenario_folders) words += ScenariosOption(folder);
  for (const std::string& setting : options.settings) words += " --set " + ShellWord(setting);
  return words + (options.strict ? " --strict" : "");
}

void Say(const CheckOptions& options, const CheckReport& report) {
  if (options.json) {
    PrintLines(JsonText(JsonOf(report)) + "\n");
  } else if (report.has_page) {
    PrintLines(PageOf(report, options.verbose));
  } else {
    for (std::size_t i = 0; i < report.lines.size(); ++i)
      Print("{}{}\n", i == 0 ? report.file + ": " : "", report.lines[i]);
  }
}

/// Draws the picture. Returns an error text, empty on success.
std::string DrawPicture(const Frame& frame, bool is_model, bool has_page, const std::string& file) {
  std::string unusable;
  const RendererKind renderer = RendererFromEnvironment(RendererKind::kAuto, unusable);
  if (!unusable.empty()) return unusable;
  ImageRequest request;
  request.width = 1280;
  request.height = 720;
  request.show_joints = has_page;
  request.show_names = !is_model;
  return RenderPicture(frame, request, renderer, file).value_or("");
}

int Check(const CheckOptions& options) {
  SearchPath path = DataPath(options.scenario_folders);
  path.is_strict = options.strict;
  std::string serve_options = ServeOptionsOf(options);
  if (!options.search.empty()) {
    for (const std::string& file : options.files) serve_options += Search(file, options.search, path);
  }
  RobotLibrary robots(path);
  bool failed = false, loses = false, is_model = false, has_page = false;
  FramePtr last;
  for (const std::string& file : options.files) {
    Diagnostics diagnostics;
    Checked checked = CheckFile(file, robots, diagnostics, true, options.settings);
    if (options.digests) {
      if (checked.frame != nullptr && !diagnostics.has_errors())
        PrintLines(JsonText(boost::json::value_from(DigestsNow(*checked.frame))) + "\n");
    } else {
      const CheckReport report = MakeReport(file, checked, diagnostics, path, serve_options);
      Say(options, report);
      is_model = checked.model != nullptr;
      has_page = report.has_page;
      loses = loses || report.verdict == CheckVerdict::kRunsWithLosses;
    }
    if (checked.frame != nullptr) {
      last = std::move(checked.frame);
    }
    PrintErrorLines(diagnostics.ToString());
    failed = failed || diagnostics.has_errors();
  }
  if (!options.picture.empty() && !failed) {
    if (last == nullptr) {
      PrintError("coopdyn: --picture needs a scenario, a world or a robot model\n");
      return kExitWrongUse;
    }
    if (const std::string error = DrawPicture(*last, is_model, has_page, options.picture); !error.empty()) {
      PrintError("coopdyn: {}\n", error);
      return kExitErrors;
    }
  }
  if (failed) return kExitErrors;
  return loses ? kExitLosses : kExitOk;
}

}  // namespace

void AddCheck(CLI::App& app, Chosen& chosen) {
  const auto given = std::make_shared<CheckOptions>();
  CLI::App* sub = app.add_subcommand("check", "Report errors in worlds, scenarios and robot models");
  sub->footer(
      "Exit code 0: all of it runs. 1: something does not. 2: a model or world made for other programs runs, "
      "but what is "
      "left out changes how it moves, senses or is driven.\n"
      "Example: coopdyn check my.scenario --picture my.png");
  sub->add_option("file", given->files, "Files, or bare names on the search path")->required();
  sub->add_option("--picture", given->picture,
                  "Write a picture of the (last) scenario, or of the model with its joints, PNG");
  auto* digests =
      sub->add_flag("--digests", given->digests,
                    "Instead of a summary: digests of the program and of all parts of the scenario, JSON");
  auto* json =
      sub->add_flag("--json", given->json, "One JSON object for each file, a line each (docs/models.md)");
  sub->add_flag("--verbose", given->verbose,
                "All joints, modules and findings of a model, not the first ones")
      ->excludes(json);
  digests->excludes(json);
  sub->add_flag("--strict", given->strict, kStrictHelp);
  sub->add_option("--search", given->search,
                  "Search this folder for the missing files of a model, and print the options that find them")
      ->check(CLI::ExistingDirectory)
      ->excludes(json);
  AddSettings(sub, given->settings);
  sub->add_option("--scenarios", given->scenario_folders, "A folder with scenarios, worlds and robots");
  sub->callback([&chosen, given] { chosen = [given] { return Check(*given); }; });
}

}  // namespace coopdyn
