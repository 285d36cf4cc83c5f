// SPDX-License-Identifier: MIT
#include "server/app/check_report.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <utility>

#include "server/app/left_out.h"
#include "server/app/model_text.h"
#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/model/experiment.h"
#include "server/model/missing_files.h"
#include "server/model/model_source.h"
#include "server/model/resources.h"
#include "server/model/text_file.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// The kind and name of a file, from its content.
struct Origin {
  std::string format = "scenario", name;
  bool has_page = false;
  bool is_own = true;  // made for coopdyn
};

Origin OriginOf(const std::string& file) {
  Origin origin;
  const std::string extension = ToLower(std::filesystem::path(file).extension().string());
  if (extension == ".xacro") return {"xacro", "", true, false};
  Diagnostics ignored;
  const auto text = IsPipe(file) ? std::nullopt : ReadTextFile(file, {file, 0}, ignored);
  if (!text || !IsXml(*text)) {
    if (extension == ".world") origin.format = "world";
    return extension == ".urdf" ? Origin{"URDF", "", true, false} : origin;
  }
  if (IsExperiment(*text, file)) return {"experiment", "", false, true};
  const auto root = ParseXml(*text, file, ignored);
  if (!root) {
    const std::string_view element = RootElement(*text);
    const bool is_urdf = element == "robot" || (element != "sdf" && extension == ".urdf");
    return {element == "mujoco" ? "MJCF" : is_urdf ? "URDF" : "SDF", "", true, false};
  }
  if (root->name == "mujoco") return {"MJCF", root->Attribute("model"), true, false};
  if (root->name == "robot") return {"URDF", root->Attribute("name"), true, false};
  const XmlNode* world = root->Child("world");
  const XmlNode* named = world == nullptr ? root->Child("model") : world;
  return {"SDF " + root->Attribute("version"), named == nullptr ? "" : named->Attribute("name"), true,
          HasOwnElements(*root)};
}

/// `text` without names and numbers: equal for similar texts.
std::string ShapeOf(const std::string& text) {
  std::string shape;
  bool quoted = false;
  for (const char c : text) {
    if (c == '\'') quoted = !quoted;
    if (!quoted && std::isdigit(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '-') shape += c;
  }
  return shape;
}

/// Merges similar findings: the same element left out, or texts that differ only in names and numbers (unless
/// `by_name`).
class Findings {
 public:
  explicit Findings(std::vector<Finding>& all) : all_(all) {}
  void Add(const Diagnostic& one, std::string what, std::string why, bool by_name = false) {
    const auto [place, is_new] =
        places_.emplace((one.what.empty() && !by_name ? ShapeOf(what) : what) + why, all_.size());
    if (is_new) {
      all_.push_back({one.where, std::move(what), std::move(why), one.count});
    } else {
      all_[place->second].count += one.count;
    }
  }

 private:
  std::vector<Finding>& all_;
  std::map<std::string, std::size_t> places_;
};

/// The package or model of `uri`, and how to get it.
MissingPart PartOf(const std::string& uri, const Resources& resources, const std::string& file) {
  if (uri.starts_with("http")) return {uri, 1, "gz fuel download -u " + ShellWord(uri)};
  const std::size_t begin = uri.find("//") + 2;
  const std::string part = uri.substr(begin, uri.find('/', begin) - begin);
  std::string ignored;
  if (uri.find("://") != std::string::npos && resources.Find(uri.substr(0, begin) + part, file, ignored)) {
    return {"files of " + uri.substr(0, begin) + part, 1,
            "it is there without " + uri.substr(std::min(uri.size(), begin + part.size() + 1))};
  }
  if (uri.starts_with("package://")) {
    std::string debian = ToLower(part);
    std::ranges::replace(debian, '_', '-');
    const bool is_name =
        !debian.empty() && debian.front() != '-' && debian.back() != '-' &&
        debian.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string::npos;
    return {"package " + part, 1,
            is_name ? "sudo apt install ros-$ROS_DISTRO-" + debian : "get that package"};
  }
  if (uri.starts_with("model://"))
    return {"model " + part, 1, "git clone https://github.com/osrf/gazebo_models (if it is one of Gazebo's)"};
  return {uri, 1, "copy it to where the model names it"};
}

bool Names(const Diagnostic& one, const std::string& uri) {
  return one.text.find("'" + Printable(uri) + "'") != std::string::npos;
}

std::vector<MissingPart> MissingOf(const std::vector<std::string>& uris, const Diagnostics& diagnostics,
                                   const SearchPath& path, const std::string& file) {
  const Resources resources(path, file);
  std::vector<MissingPart> parts;
  for (const std::string& uri : uris) {
    // Skip files that no diagnostic names, such as material scripts: no reader looks for them.
    if (std::ranges::none_of(diagnostics.all(), [&](const Diagnostic& one) { return Names(one, uri); }))
      continue;
    MissingPart part = PartOf(uri, resources, file);
    part.collides = std::ranges::any_of(diagnostics.all(), [&](const Diagnostic& one) {
      return one.level != Diagnostic::Level::kNote && Names(one, uri);
    });
    const auto same = std::ranges::find(parts, part.what, &MissingPart::what);
    if (same == parts.end()) {
      parts.push_back(std::move(part));
    } else {
      ++same->count;
      same->collides = same->collides || part.collides;
    }
  }
  return parts;
}

/// Adds to `left_out` the file `uri`, which `one` reports as not found.
void AddMissing(const Diagnostic& one, const std::string& uri, Findings& left_out) {
  constexpr std::string_view kUntil = "until then ";
  const std::size_t until = one.text.find(kUntil);
  const std::string why = until == std::string::npos ? "" : one.text.substr(until + kUntil.size());
  if (one.text.starts_with("mesh")) return left_out.Add(one, "a mesh that is not found", why);
  const bool is_model = one.text.starts_with("<include>");
  const std::string what = (is_model ? "model '" : "file '") + uri + "' is not found";
  left_out.Add(one, what, is_model ? why : one.text.substr(0, one.text.find(": there is no ")), true);
}

/// In a world, the owner of a plug-in is unknown: prefer a robot that has a module in its place.
Consequence ConsequenceIn(const Diagnostic& warning, const Checked& checked) {
  Consequence of_none = ConsequenceOf(warning, checked.model.get());
  if (checked.model != nullptr || checked.frame == nullptr) return of_none;
  const RobotModel* last = nullptr;
  for (const SceneRobot& robot : checked.frame->scene->robots) {
    const RobotModel* const model = robot.entry.model.get();
    if (std::exchange(last, model) == model) continue;
    if (Consequence consequence = ConsequenceOf(warning, model); !consequence.matters) return consequence;
  }
  return of_none;
}

/// Summary of a third-party world; robots have their own lines.
std::string WorldText(const Scene& scene, std::size_t with_sockets) {
  const Scenario& scenario = *scene.scenario;
  const auto counted = [](std::size_t all, const char* noun, std::size_t some, const char* what) {
    if (all == 0) return std::string("no ") + noun + "s, ";
    return CountOf(all, noun) + " (" + std::to_string(some) + what + "), ";
  };
  const auto fixed =
      static_cast<std::size_t>(std::ranges::count_if(scenario.objects, &WorldObject::is_static));
  const std::string step = FormatNumber(1e3 * ToSeconds(scenario.simulation.step.value_or(kDefaultStep)));
  return counted(scene.robots.size(), "robot", with_sockets, " with sockets") +
         counted(scenario.objects.size(), "object", fixed, " fixed") + "floor " +
         FormatNumber(scenario.floor.length_m) + " x " + FormatNumber(scenario.floor.width_m) +
         " m, steps of " + step + " ms";
}

/// Adds the robots of a world and their drive lines; report.drive is for the first robot with a motor.
void AddRobots(const Scene& scene, const std::string& options, double step_s, CheckReport& report) {
  std::size_t with_sockets = 0;
  bool has_motor = false;
  for (const SceneRobot& robot : scene.robots) {
    const RobotEntry& entry = robot.entry;
    report.robots.push_back({entry.name, entry.model, {}});
    if (!entry.sockets) continue;
    CheckedRobot& added = report.robots.back();
    added.drive = DriveLinesFor(report.file, options, entry.name, entry.model.get(), step_s);
    report.model = ++with_sockets == 1 ? entry.model : nullptr;
    if (report.drive && (has_motor || !entry.model->has_actuators())) continue;
    report.drive = added.drive;
    has_motor = entry.model->has_actuators();
  }
  if (!report.drive) report.drive = DriveLinesFor(report.file, options, "", nullptr, step_s);
  report.lines = {WorldText(scene, with_sockets)};
}

}  // namespace

const char* ToString(CheckVerdict verdict) {
  if (verdict == CheckVerdict::kRuns) return "runs";
  return verdict == CheckVerdict::kRunsWithLosses ? "runs with losses" : "will not run";
}

CheckReport MakeReport(const std::string& file, const Checked& checked, const Diagnostics& diagnostics,
                       const SearchPath& path, const std::string& options) {
  // A bare name stands for a file on the search path.
  const bool is_scenario = checked.frame != nullptr && checked.model == nullptr;
  const std::string found = is_scenario ? checked.frame->scene->scenario->file : file;
  const Origin origin = OriginOf(found);
  CheckReport report;
  report.file = file;
  report.format = origin.format;
  report.name = origin.name;
  report.has_page = origin.has_page;
  report.lines = checked.lines;
  report.model = checked.model;
  if (checked.frame != nullptr && report.name.empty())
    report.name = report.model != nullptr ? report.model->type : checked.frame->scene->scenario->name;
  std::vector<std::string> uris;
  if (origin.has_page && !diagnostics.all().empty()) uris = MissingUris(found, path);
  report.missing = MissingOf(uris, diagnostics, path, found);

  bool loses = false;
  Findings errors(report.errors), mended(report.mended), left_out(report.left_out), harmless(report.harmless);
  for (const Diagnostic& one : diagnostics.all()) {
    const auto missing = std::ranges::find_if(uris, [&](const std::string& uri) { return Names(one, uri); });
    const bool is_missing = missing != uris.end();
    const Consequence consequence =
        one.level == Diagnostic::Level::kWarning ? ConsequenceIn(one, checked) : Consequence{};
    const std::string& what = one.what.empty() ? one.text : one.what;
    if (one.level == Diagnostic::Level::kError) {
      errors.Add(one, one.text, "");
    } else if (one.level == Diagnostic::Level::kMended) {
      mended.Add(one, one.text, "");
    } else if (one.level == Diagnostic::Level::kNote || !consequence.matters) {
      if (!is_missing) harmless.Add(one, what, consequence.why);
    } else {
      loses = true;
      if (is_missing)
        AddMissing(one, *missing, left_out);
      else
        left_out.Add(one, what, consequence.why);
    }
  }
  const std::size_t said =
      static_cast<std::size_t>(diagnostics.errors()) + static_cast<std::size_t>(diagnostics.warnings());
  if (said > diagnostics.all().size() && !diagnostics.has_errors()) {
    loses = true;
    report.left_out.push_back(
        {{file, 0},
         std::to_string(said - diagnostics.all().size()) + " more warnings, which are not kept",
         "",
         1});
  }
  if (diagnostics.has_errors() || checked.frame == nullptr) {
    report.verdict = CheckVerdict::kWillNotRun;
    return report;
  }
  if (loses && !origin.is_own) report.verdict = CheckVerdict::kRunsWithLosses;
  if (!origin.has_page) return report;
  const Scene& scene = *checked.frame->scene;
  const double step_s = ToSeconds(scene.scenario->simulation.step.value_or(kDefaultStep));
  if (report.model == nullptr)
    AddRobots(scene, options, step_s, report);
  else
    report.drive = DriveLinesFor(file, options, "robot1", report.model.get(), step_s);
  return report;
}

}  // namespace coopdyn
