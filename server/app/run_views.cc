// SPDX-License-Identifier: MIT
#include "server/app/run_views.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <boost/json.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "protocol/json_text.h"
#include "server/model/text_file.h"
#include "server/record/player_frames.h"
#include "server/replay/export_tables.h"
#include "server/replay/verify.h"
#include "server/sensing/readings.h"
#include "server/web/pose_stream.h"
#include "server/web/scene_json.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;
namespace json = boost::json;

constexpr std::size_t kMaxMarks = 10'000;
constexpr std::size_t kMaxPoseBytes = 48'000'000;
constexpr std::uintmax_t kMaxTableBytes = 64'000'000;
constexpr const char* kEnding = "the daemon ends";

HttpAnswer Damaged(const RunReader& run) {
  return ErrorAnswer(409, run.error());
}

/// An answer that must not be cached.
HttpAnswer Bytes(std::string body, const char* type) {
  return {.body = std::move(body), .type = type, .headers = {{"Cache-Control", "no-store"}}};
}

/// The robot's sensors with a fixed number of values.
std::vector<std::string> SensorsOf(const Scene& scene, const std::string& robot) {
  std::vector<std::string> names;
  for (const SceneRobot& one : scene.robots) {
    if (one.entry.name != robot) continue;
    for (const SensorModel& sensor : one.entry.model->sensors) {
      if (FixedCount(sensor.kind) != 0) names.push_back(sensor.name);
    }
  }
  return names;
}

}  // namespace

HttpAnswer TimelineOf(RunReader& run) {
  const RunExtent extent = run.extent();
  json::array keyframes, events;
  for (const std::uint64_t step : run.Keyframes()) {
    if (keyframes.size() >= kMaxMarks) break;
    const std::optional<RecordedStep> read = run.Read(step, true);
    if (read) keyframes.emplace_back(ToSeconds(read->time));
  }
  if (!run.error().empty()) return Damaged(run);
  for (const Event& event : run.Events()) {
    if (events.size() >= kMaxMarks) break;
    if (event.level == kLogLevel) continue;  // shown as a plot, not as a mark
    events.push_back({{"time_s", event.time_s}, {"level", event.level}, {"text", event.text}});
  }
  return JsonAnswer(JsonText(json::object{{"name", fs::path(run.file()).filename().string()},
                                          {"begin_s", ToSeconds(extent.begin)},
                                          {"end_s", ToSeconds(extent.end)},
                                          {"steps", extent.steps},
                                          {"keyframes", std::move(keyframes)},
                                          {"events", std::move(events)}}));
}

HttpAnswer PartingOf(RunReader& one, RunReader& other, const ReplayServices& services) {
  const VerifyReport report = Compare(one, other, services, [](double) {});
  if (!report.error.empty()) return ErrorAnswer(409, report.error);
  json::object said{{"equal", !report.difference}, {"steps", report.steps}, {"text", ToString(report)}};
  if (const std::optional<Difference>& difference = report.difference) {
    said["step"] = difference->step;
    said["time_s"] = ToSeconds(difference->time);
    said["what"] = difference->what;
    said["field"] = difference->field;
    said["one"] = difference->recorded;
    said["other"] = difference->repeated;
  }
  return JsonAnswer(JsonText(said));
}

HttpAnswer SceneOf(RunReader& run) {
  const SavedStatePtr first = run.Keyframe(run.extent().first);
  if (first == nullptr) return Damaged(run);
  return JsonAnswer(SceneJson(*first->frame, 0));
}

HttpAnswer PosesOf(RunReader& run, double rate_hz, const std::stop_token& stop) {
  const RunExtent extent = run.extent();
  const auto every = static_cast<Nanoseconds>(1e9 / std::clamp(rate_hz, 0.1, 60.0));
  PlayFrames frames(run);
  PoseStream stream;
  std::string bytes;
  std::optional<std::uint64_t> step = run.StepAt(extent.begin, true);
  const Scene* scene = nullptr;
  for (Nanoseconds due = extent.begin; step; due += every) {
    if (stop.stop_requested()) return ErrorAnswer(503, kEnding);
    const std::shared_ptr<Frame> frame = frames.Make(*step);
    if (frame == nullptr) return Damaged(run);
    if (scene == nullptr) scene = frame->scene.get();
    if (frame->scene.get() != scene) break;  // the scene changed: the ghost ends here
    const std::string message = stream.Next(*frame, 0);
    for (unsigned shift = 0; shift < 32; shift += 8)
      bytes += static_cast<char>(message.size() >> shift & 255U);
    bytes += message;
    if (bytes.size() > kMaxPoseBytes) {
      return ErrorAnswer(413, "this run is too long for a ghost: it would take more than 48 MB");
    }
    while (due <= frame->time) due += every;
    std::optional<std::uint64_t> next = run.StepAt(due, true);
    if (next && *next <= *step) next = run.NextShown(*step, false);
    step = next;
  }
  if (!run.error().empty()) return Damaged(run);
  return Bytes(std::move(bytes), "application/octet-stream");
}

HttpAnswer TableOf(RunReader& run, const std::string& robot, int points, const std::stop_token& stop) {
  const RunExtent extent = run.extent();
  const SavedStatePtr first = run.Keyframe(extent.first);
  if (first == nullptr) return Damaged(run);
  ExportOptions options;
  const std::vector<std::string> none;
  options.robots = options.objects = none;
  if (!robot.empty()) {
    options.robots = {robot};
    options.scores = options.logged = none;
    options.readings = SensorsOf(*first->frame->scene, robot);
  }
  options.every_s = ToSeconds(extent.end - extent.begin) / std::clamp(points, 2, 100'000);
  std::string folder = (fs::temp_directory_path() / "coopdyn-table-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return ErrorAnswer(507, "there is no room for a table");
  const std::string file = folder + "/table.csv";
  const std::string error = ExportCsv(run, options, file, [&stop](double) { return !stop.stop_requested(); });
  std::error_code missing;
  const std::uintmax_t size = fs::file_size(file, missing);
  std::string text;
  if (error.empty() && !missing && size <= kMaxTableBytes) {
    std::ifstream in(file, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(in), {});
  }
  fs::remove_all(folder, missing);
  if (stop.stop_requested()) return ErrorAnswer(503, kEnding);
  if (!error.empty()) return ErrorAnswer(409, error);
  if (text.empty()) return ErrorAnswer(413, "the table would be too large: ask for fewer points");
  return Bytes(std::move(text), "text/csv; charset=utf-8");
}

}  // namespace coopdyn
