// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/print.h"
#include "server/app/progress_bar.h"
#include "server/app/shutdown.h"
#include "server/replay/export_file.h"
#include "server/replay/export_pictures.h"
#include "server/replay/export_tables.h"

namespace coopdyn {

namespace {

constexpr std::array kFormats{"csv", "mat", "png", "mp4"};

struct Given {
  std::string run, to, out, robots, objects, scores, logged, readings, camera, size = "640x480";
  std::vector<double> eye_m, look_m;
  std::vector<std::string> scenario_folders;
  std::optional<double> time_s;
  ExportOptions options;
  PictureOptions pictures;
};

/// Parses `a,b,c`; `none` means no names.
std::vector<std::string> ReadNames(const std::string& option, const std::string& text) {
  std::vector<std::string> names;
  if (text == "none") return names;
  std::string rest = text + ",";
  for (auto comma = rest.find(','); comma != std::string::npos; comma = rest.find(',')) {
    std::string name = rest.substr(0, comma);
    rest.erase(0, comma + 1);
    std::erase(name, ' ');
    if (name.empty()) throw CLI::ValidationError(option + ": write names with commas in between, or none");
    names.push_back(std::move(name));
  }
  return names;
}

void ReadSize(const std::string& text, ImageRequest& image) {
  char after = 0;
  if (std::sscanf(text.c_str(), "%4dx%4d%c", &image.width, &image.height, &after) != 2)
    throw CLI::ValidationError("--size: write WIDTHxHEIGHT in pixels, e.g. 640x480");
  if (const std::string error = CheckImageRequest(image); !error.empty())
    throw CLI::ValidationError("--size: " + error);
}

/// Parses `robot1` or `robot1/left_camera`.
void ReadCamera(const CLI::App& sub, const std::string& text, ImageRequest& image) {
  for (const char* option : {"--size", "--eye", "--look", "--rays"}) {
    if (sub.count(option) > 0)
      throw CLI::ValidationError(std::string(option) +
                                 " is for the view, --camera for a robot's camera: choose");
  }
  const std::size_t slash = text.find('/');
  CameraShot& shot = image.shot.emplace();
  shot.robot_name = text.substr(0, slash);
  shot.module = slash == std::string::npos ? CameraModel::kType : text.substr(slash + 1);
  if (shot.robot_name.empty() || shot.module.empty())
    throw CLI::ValidationError("--camera: write ROBOT or ROBOT/MODULE, e.g. robot1/camera");
}

/// "csv" for `a.csv`; empty for an unknown extension.
std::string FormatOf(const std::string& out) {
  const std::string extension = std::filesystem::path(out).extension().string();
  const auto* const found = std::find_if(kFormats.begin(), kFormats.end(),
                                         [&](const char* f) { return extension == std::string(".") + f; });
  return found == kFormats.end() ? "" : *found;
}

/// Fills in defaults; throws if an option does not apply to the format.
void Complete(const CLI::App& sub, Given& given) {
  if (given.to.empty()) given.to = FormatOf(given.out);
  if (std::find(kFormats.begin(), kFormats.end(), given.to) == kFormats.end())
    throw CLI::ValidationError("--to: write csv, mat, png or mp4");
  const bool table = given.to == "csv" || given.to == "mat";
  const std::vector<const char*> not_mine =
      table ? std::vector<const char*>{"--size", "--fps",  "--speed", "--eye",
                                       "--look", "--rays", "--time",  "--camera"}
            : std::vector<const char*>{"--robots", "--objects",  "--scores",
                                       "--logged", "--readings", "--every"};
  for (const char* option : not_mine) {
    if (sub.count(option) > 0)
      throw CLI::ValidationError(std::string(option) + " is for --to " +
                                 (table ? "png and mp4" : "csv and mat"));
  }
  if (given.time_s) {
    if (given.to != "png") throw CLI::ValidationError("--time is for --to png: one picture");
    for (const char* option : {"--from", "--until", "--fps", "--speed"}) {
      if (sub.count(option) > 0)
        throw CLI::ValidationError(std::string(option) + " is for many pictures, --time for one: choose");
    }
  }
  if (sub.count("--robots") > 0) given.options.robots = ReadNames("--robots", given.robots);
  if (sub.count("--objects") > 0) given.options.objects = ReadNames("--objects", given.objects);
  if (sub.count("--scores") > 0) given.options.scores = ReadNames("--scores", given.scores);
  if (sub.count("--logged") > 0) given.options.logged = ReadNames("--logged", given.logged);
  if (sub.count("--readings") > 0) given.options.readings = ReadNames("--readings", given.readings);
  ImageRequest& image = given.pictures.image;
  ReadSize(given.size, image);
  if (!given.eye_m.empty()) image.eye_m = Vector3(given.eye_m[0], given.eye_m[1], given.eye_m[2]);
  if (!given.look_m.empty()) image.look_m = Vector3(given.look_m[0], given.look_m[1], given.look_m[2]);
  if (const std::string error = CheckImageRequest(image); !error.empty()) throw CLI::ValidationError(error);
  if (!given.camera.empty()) ReadCamera(sub, given.camera, image);
  if (given.out.empty()) {
    const bool folder = given.to == "png" && !given.time_s;
    given.out = WithSuffix(given.run, folder ? "-png" : "." + given.to);
  }
}

int Fail(const std::string& text) {
  PrintError("coopdyn: export: {}\n", text);
  return kExitErrors;
}

std::string Write(RunReader& reader, const Given& given, const ExportProgress& progress) {
  if (given.to == "csv") return ExportCsv(reader, given.options, given.out, progress);
  if (given.to == "mat") return ExportMat(reader, given.options, given.out, progress);
  if (given.to == "mp4") return ExportVideo(reader, given.options, given.pictures, given.out, progress);
  if (given.time_s)
    return ExportPicture(reader, *given.time_s, given.pictures, given.out, given.options.overwrite);
  return ExportPictures(reader, given.options, given.pictures, given.out, progress);
}

int Export(Given given) {
  Shutdown shutdown;  // Ctrl-C stops the export and leaves no file behind
  SetRendererDefaults();
  std::string error;
  given.pictures.renderer = RendererFromEnvironment(RendererKind::kAuto, error);
  if (!error.empty()) return Fail(error);
  const auto reader = RunReader::Open(given.run, error);
  if (reader == nullptr) return Fail(error);
  std::error_code missing;
  if (std::filesystem::equivalent(given.out, reader->file(), missing)) {
    return Fail(given.out + " is the recording itself: write another name");
  }
  if (reader->mended()) PrintError("{}: had not been closed; it is mended\n", given.run);
  const SearchPath path = DataPath(given.scenario_folders);
  Diagnostics diagnostics;
  const auto scenario = reader->LoadScenario(path, diagnostics);
  if (scenario == nullptr) {
    PrintErrorLines(diagnostics.ToString());
    return Fail(given.run + ": the scenario in it cannot be read");
  }
  {
    const SteadyClock clock;
    const LogBackend log("warning");
    ProgressBar bar(clock, log.logger());
    error = Write(*reader, given, [&](double share) {
      bar.Show(share);
      return shutdown.Wait(0) != Shutdown::Wake::kEnd;
    });
  }
  if (!error.empty()) return Fail(error);
  Print("wrote {}{}\n", given.out, given.to == "csv" ? " and " + EventsFile(given.out) : std::string());
  return kExitOk;
}

}  // namespace

void AddExport(CLI::App& app, Chosen& chosen) {
  const auto given = std::make_shared<Given>();
  CLI::App* sub = app.add_subcommand("export", "Write a recorded run for other programs");
  sub->footer(
      "Examples: coopdyn export lesson1.run --to csv --robots robot1,robot2 --every 0.1\n"
      "          coopdyn export lesson1.run --to mp4 --speed 4 --size 1280x720");
  sub->add_option("run", given->run, "A recorded run, NAME.run")->required();
  sub->add_option(
      "--to", given->to,
      "csv: one table, and one of the events · mat: for load in MATLAB and Octave · png: pictures "
      "· mp4: a film, by ffmpeg");
  sub->add_option("--out", given->out, "Output file or folder (default: beside the run, under its name)");
  sub->add_option("--from", given->options.from_s, "First simulated time, s");
  sub->add_option("--until", given->options.until_s, "Last simulated time, s");
  sub->add_option("--robots", given->robots, "Names, also of swarms: a,b,c; none (default: all)");
  sub->add_option("--objects", given->objects, "Names of things that move: a,b,c; none (default: all)");
  sub->add_option("--scores", given->scores, "Names of scores: a,b,c; none (default: all)");
  sub->add_option("--logged", given->logged, "Names of logged numbers: a,b,c; none (default: all)");
  sub->add_option("--readings", given->readings,
                  "Also readings of these sensors, by name or type: imu,lidar (default: none)");
  sub->add_option("--every", given->options.every_s, "Simulated seconds between rows (default: every step)");
  sub->add_option("--size", given->size, "Of the pictures, pixels")->capture_default_str();
  sub->add_option("--fps", given->pictures.fps, "Pictures per second of the film")->capture_default_str();
  sub->add_option("--speed", given->pictures.speed, "Simulated seconds per second of the film")
      ->capture_default_str();
  sub->add_option("--eye", given->eye_m, "x,y,z of the camera, m (default: sees all)")
      ->delimiter(',')
      ->expected(3);
  sub->add_option("--look", given->look_m, "x,y,z of the middle of the picture, m")
      ->delimiter(',')
      ->expected(3);
  sub->add_option("--camera", given->camera, "Pictures of a robot's camera: ROBOT or ROBOT/MODULE");
  sub->add_flag("--rays", given->pictures.image.show_rays,
                "Show the view of sensors: rays, scans, cones, fields of view");
  sub->add_option("--time", given->time_s, "One picture, of this simulated time, s");
  sub->add_option("--scenarios", given->scenario_folders, "A folder with controllers that the run names");
  sub->add_flag("--force", given->options.overwrite,
                "Overwrite an existing file, unless it is a recording or a scenario");
  sub->callback([sub, given, &chosen] {
    Complete(*sub, *given);
    chosen = [given] { return Export(*given); };
  });
}

}  // namespace coopdyn
