// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/print.h"
#include "server/model/mjcf.h"
#include "server/model/readers.h"
#include "server/model/resources.h"
#include "server/model/text_file.h"
#include "server/rosiml/translate.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

struct ConvertOptions {
  std::string file, out;
  std::vector<std::string> scenario_folders;
};

int Refuse(const std::string& why) {
  PrintError("coopdyn: {}\n", why);
  return kExitErrors;
}

bool Write(const fs::path& file, const std::string& text) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  return stream.good();
}

/// Converts a MuJoCo file to NAME.sdf and its meshes.
int ConvertMjcf(const std::string& file, const SearchPath& path, const std::string& wanted_out) {
  const std::string name = fs::path(file).stem().string();
  const fs::path out = wanted_out.empty() ? fs::path(name) : fs::path(wanted_out);
  const fs::path target = out / (name + ".sdf");
  std::error_code error;
  for (const fs::path& one : {target, out / "meshes"}) {
    if (fs::exists(one, error))
      return Refuse(one.string() + " is there already: name another folder with --out");
  }
  Diagnostics diagnostics;
  const auto text = TranslateMjcf(file, path, out / "meshes", "meshes/", diagnostics);
  PrintErrorLines(diagnostics.ToString());
  if (!text) return kExitErrors;
  if (!Write(target, *text)) return Refuse(target.string() + " cannot be written");
  Print("wrote {0}; continue with\n  coopdyn serve {0}\n", target.string());
  return kExitOk;
}

int Convert(const ConvertOptions& options) {
  const SearchPath path = DataPath(options.scenario_folders);
  const auto found = path.FindScenario(options.file);
  Diagnostics diagnostics;
  const std::string file = found ? found->string() : options.file;
  const auto text = ReadTextFile(file, {file, 0}, diagnostics);
  if (text && IsMjcf(*text)) return ConvertMjcf(file, path, options.out);
  std::set<fs::path> controllers;  // found beside the experiment
  const auto has_controller = [&](const std::string& controller) {
    const auto beside = path.FindController(controller, fs::absolute(file).parent_path());
    if (beside && path.FindController(controller) != beside) controllers.insert(*beside);
    return beside.has_value();
  };
  auto made = text ? rosiml::Translate(*text, file, "robots/", diagnostics, has_controller) : std::nullopt;
  if (made) {  // check it as `serve` would
    RobotLibrary robots(path);
    Diagnostics again;
    if (LoadScenario(file, robots, again) == nullptr) made.reset();
    diagnostics = std::move(again);
  }
  PrintErrorLines(diagnostics.ToString());
  if (!made) return kExitErrors;
  const std::string name = fs::path(file).stem().string();
  const fs::path out = options.out.empty() ? fs::path(name) : fs::path(options.out);
  const fs::path scenario = out / (name + ".scenario");
  std::vector<std::pair<fs::path, std::string>> files;
  std::map<fs::path, fs::path> meshes;
  for (rosiml::MadeModel& model : made->models) {
    const fs::path folder = (out / "robots" / model.name).lexically_normal();
    files.emplace_back(folder / "model.sdf", std::move(model.sdf.text));
    for (const std::string& mesh : model.mesh_files) {
      const fs::path target = (folder / mesh).lexically_normal();
      const auto [in_folder, in_target] = std::ranges::mismatch(folder, target);
      if (in_folder != folder.end())
        return Refuse("the mesh '" + mesh + "' does not lie beside the experiment: move it there");
      std::string why;
      if (const auto source = Resources(path, file).Find(mesh, file, why)) meshes[target] = *source;
    }
  }
  files.emplace_back(scenario, std::move(made->scenario.text));
  for (const auto& [target, content] : files) {
    std::error_code error;
    if (fs::exists(target, error))
      return Refuse(target.string() + " is there already: name another folder with --out");
  }
  for (const auto& [target, content] : files) {
    if (!Write(target, content)) return Refuse(target.string() + " cannot be written");
  }
  for (const fs::path& controller : controllers) {
    std::error_code error;
    fs::create_directories(out / "controllers", error);
    const fs::path target = out / "controllers" / controller.filename();
    if (!fs::copy_file(controller, target, fs::copy_options::skip_existing, error) && error)
      return Refuse(target.string() + " cannot be written");
  }
  for (const auto& [target, source] : meshes) {
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    if (!fs::copy_file(source, target, error)) return Refuse(target.string() + " cannot be written");
  }
  Print("wrote {0}; continue with\n  coopdyn serve {0}\n", scenario.string());
  return kExitOk;
}

}  // namespace

void AddConvert(CLI::App& app, Chosen& chosen) {
  const auto given = std::make_shared<ConvertOptions>();
  CLI::App* sub = app.add_subcommand("convert", "Write an experiment of YARS, or a model of MuJoCo, as SDF");
  sub->footer("Example: coopdyn convert experiment.xml --out mine && coopdyn serve mine/experiment.scenario");
  sub->add_option("file", given->file, "An .xml file, or a bare name on the search path")->required();
  sub->add_option("--out", given->out, "The folder to write (default: the file's name)");
  sub->add_option("--scenarios", given->scenario_folders, "A folder with scenarios, worlds and robots");
  sub->callback([&chosen, given] { chosen = [given] { return Convert(*given); }; });
}

}  // namespace coopdyn
