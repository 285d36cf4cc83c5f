// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/json.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <utility>

#include "clients/cpp/coopdyn_client.h"
#include "protocol/json_text.h"
#include "server/app/commands.h"
#include "server/render/gl_objects.h"
#include "server/render/picture_maker.h"
#include "server/sensing/readings.h"
#include "server/sensing/sensing_cache.h"
#include "tests/bench/bench_commands.h"
#include "tests/bench/bench_daemon.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/measures.h"
#include "tests/bench/sensor_room.h"

namespace coopdyn {

namespace {

struct SensorBench {
  double seconds = 0.5;  // of CPU, of each measurement
  int repeats = 3;
  RendererKind renderer = RendererKind::kAuto;
  bool json = false;
  std::vector<std::string> folders;
};

/// Figures of one picture size; ms of CPU, except for the latencies.
struct PictureFigures {
  CameraSize size;
  double rgb_ms = 0, jpeg_ms = 0, depth_ms = 0;  // drawn, read back and encoded
  double read_ms = 0;                            // back from GL
  double served_ms = 0;                          // by the daemon, raw, without the step
  double latency_ms = 0, latency_99_ms = 0;      // of wall time
};

struct Row {
  std::string name;
  double value = 0;
};

struct SensorFigures {
  std::string renderer;
  std::vector<PictureFigures> pictures;
  std::vector<Row> rays;      // millions a second of CPU
  std::vector<Row> readings;  // µs of CPU
  std::vector<Row> unread;    // µs of CPU of a robot-step
};

/// CPU seconds of one call of `once(i)`, the median of the repeats. `before(i)` prepares it and is not
/// counted, except that a slow one ends the measurement sooner; i cycles from 0 to `count` - 1.
template <typename Before, typename Once>
double OneCall_s(const SensorBench& bench, int count, Before before, Once once) {
  constexpr double kMostBefore = 4;  // relative to the counted time
  std::vector<double> all;
  for (int repeat = 0; repeat < bench.repeats; ++repeat) {
    const double start_s = OwnCpu_s();
    double spent_s = 0;
    double calls = 0;
    do {
      before();
      const double began_s = OwnCpu_s();
      for (int i = 0; i < count; ++i) once(i);
      spent_s += OwnCpu_s() - began_s;
      calls += count;
    } while (spent_s < bench.seconds && OwnCpu_s() - start_s < (1 + kMostBefore) * bench.seconds);
    all.push_back(spent_s / calls);
  }
  return Median(std::move(all));
}

constexpr int kFrames = 100;

std::size_t SensorCalled(const Scene& scene, const std::string& module) {
  const std::vector<SensorModel>& sensors = scene.robots.front().entry.model->sensors;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (sensors[i].name == module) return i;
  }
  throw std::runtime_error("the robot has no " + module);
}

// --- pictures

double PictureOf_ms(const SensorBench& bench, PictureMaker& maker, const std::shared_ptr<const Scene>& room,
                    const CameraSize& size, ImageFormat format) {
  ImageRequest request;
  request.format = format;
  request.shot = CameraShot{nullptr, 0, SensorCalled(*room, size.module)};
  constexpr int kPictures = 20;
  const auto frames = FramesOf(room, kPictures);
  // A new frame each time: the maker caches the pictures of the newest.
  const auto draw = [&](int i) {
    const ImageResult result = maker.Make(*frames[static_cast<std::size_t>(i)], request);
    if (!result.error.empty()) throw std::runtime_error(result.error);
  };
  for (int i = 0; i < kPictures; ++i) draw(i);  // compiles shaders
  return 1e3 * OneCall_s(
                   bench, kPictures, [] {}, draw);
}

double ReadBack_ms(const SensorBench& bench, const CameraSize& size) {
  std::string error;
  const auto context = GlContext::Create(bench.renderer, error);
  if (context == nullptr) throw std::runtime_error("no pictures: " + error);
  const GlApi& gl = context->gl();
  const GlTarget target(gl, size.width, size.height, 0);
  target.Bind();
  gl.Clear(GL_COLOR_BUFFER_BIT);
  std::vector<unsigned char> rgb(static_cast<std::size_t>(size.width * size.height) * 3);
  target.Read(rgb.data());  // waits for the clearing
  const auto read = [&](int /*i*/) { target.Read(rgb.data()); };
  return 1e3 * OneCall_s(
                   bench, 20, [] {}, read);
}

/// The daemon's CPU time and the client's wait, for a step and a picture after it.
void Serve(const SensorBench& bench, const std::map<std::string, std::string>& files, PictureFigures& of) {
  using Clock = std::chrono::steady_clock;
  BenchDaemonOptions options;
  options.files = files;
  options.words = {"--renderer", ToString(bench.renderer)};
  const BenchDaemon daemon(options);
  client::Simulation sim = client::connect(daemon.address());
  sim.set_participants({"robot1"});
  client::Robot robot = sim.robot("robot1");
  constexpr int kWarmUp = 5;
  const int rounds = std::max(20, static_cast<int>(bench.seconds * bench.repeats * 100));
  const auto round = [&](bool with_picture) {
    robot.set_velocity(0.05, 0.5);
    sim.step();
    const auto asked = Clock::now();
    if (with_picture) robot.get_image(of.size.module);
    return std::chrono::duration<double, std::milli>(Clock::now() - asked).count();
  };
  for (int i = 0; i < kWarmUp; ++i) round(true);
  std::vector<double> waits_ms;
  const double began_s = CpuOf_s(daemon.pid());
  for (int i = 0; i < rounds; ++i) waits_ms.push_back(round(true));
  const double with_s = CpuOf_s(daemon.pid()) - began_s;
  for (int i = 0; i < rounds; ++i) round(false);
  const double without_s = CpuOf_s(daemon.pid()) - began_s - with_s;
  of.served_ms = 1e3 * (with_s - without_s) / rounds;
  std::sort(waits_ms.begin(), waits_ms.end());
  of.latency_99_ms = waits_ms[waits_ms.size() * 99 / 100];
  of.latency_ms = Median(std::move(waits_ms));
}

// --- readings

/// CPU seconds of reading a sensor of the first robot, with a frame whose cache lacks only this sensor.
double ReadingOf_s(const SensorBench& bench, const std::shared_ptr<const Scene>& scene, std::size_t sensor) {
  const SensorKind& kind = scene->robots.front().entry.model->sensors[sensor].kind;
  const bool is_kept = std::visit([]<typename Kind>(const Kind&) { return IsKept<Kind>; }, kind);
  std::vector<std::unique_ptr<const Frame>> frames;
  std::vector<double> data;
  const auto before = [&] {
    if (!is_kept && !frames.empty()) return;  // not cached
    frames = FramesOf(scene, kFrames);
    for (const auto& frame : frames) SensingCache::Of(*frame);
  };
  return OneCall_s(bench, kFrames, before, [&](int i) {
    data.clear();
    AppendReading(*frames[static_cast<std::size_t>(i)], 0, sensor, data);
  });
}

void MeasureReadings(const SensorBench& bench, const std::shared_ptr<const Scene>& room,
                     SensorFigures& figures) {
  const auto million_rays = [&](const std::shared_ptr<const Scene>& scene, const std::string& module) {
    const std::size_t sensor = SensorCalled(*scene, module);
    const auto& lidar = std::get<LidarModel>(scene->robots.front().entry.model->sensors[sensor].kind);
    return static_cast<double>(lidar.rays()) / ReadingOf_s(bench, scene, sensor) / 1e6;
  };
  const std::shared_ptr<const Scene> hills = HillsAround(*room);
  figures.rays = {{"a room of 64 things, 360 rays in a plane", million_rays(room, "lidar")},
                  {"the room, 16 x 360 rays", million_rays(room, "lidar_3d")},
                  {"a mesh of 100,352 triangles, 360 rays", million_rays(hills, "lidar")},
                  {"the mesh, 16 x 360 rays", million_rays(hills, "lidar_3d")}};
  std::vector<std::unique_ptr<const Frame>> frames;
  figures.readings.push_back(
      {"once a step, whatever is read",
       1e6 * OneCall_s(
                 bench, kFrames, [&] { frames = FramesOf(room, kFrames); },
                 [&](int i) { SensingCache::Of(*frames[static_cast<std::size_t>(i)]); })});
  const std::vector<SensorModel>& sensors = room->robots.front().entry.model->sensors;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (std::holds_alternative<CameraModel>(sensors[i].kind)) continue;
    figures.readings.push_back({sensors[i].name, 1e6 * ReadingOf_s(bench, room, i)});
  }
}

/// µs of CPU of a robot-step of 20 robots with these sensors that nobody reads.
double Unread_us(const SensorBench& bench, Sensors sensors, const SearchPath& path) {
  constexpr int kRobots = 20;
  const auto scene = RoomOf(RoomFiles(sensors, kRobots, path), path);
  BenchRunOptions options;
  options.seconds = 40 * bench.seconds;  // simulated, of some 10 ms of CPU each
  Diagnostics diagnostics;
  std::vector<double> all;
  for (int repeat = 0; repeat < bench.repeats; ++repeat) {
    const auto run = RunOnce(scene->scenario, options, diagnostics);
    if (!run) throw std::runtime_error(diagnostics.ToString());
    all.push_back(1e6 * run->cpu_s / static_cast<double>(run->steps) / kRobots);
  }
  return Median(std::move(all));
}

SensorFigures Measure(const SensorBench& bench) {
  const SearchPath path = DataPath(bench.folders);
  const auto files = RoomFiles(Sensors::kAll, 6, path);
  const auto room = RoomOf(files, path);
  SensorFigures figures;
  MeasureReadings(bench, room, figures);
  for (const auto& [name, sensors] : {std::pair{"no sensors", Sensors::kNone},
                                      std::pair{"12 that are computed when asked", Sensors::kComputed},
                                      std::pair{"and 5 that physics measures", Sensors::kAll}})
    figures.unread.push_back({name, Unread_us(bench, sensors, path)});
  for (const CameraSize& size : kCameraSizes) {
    PictureFigures of{size};
    of.read_ms = ReadBack_ms(bench, size);
    PictureMaker maker(bench.renderer);
    of.rgb_ms = PictureOf_ms(bench, maker, room, size, ImageFormat::kRgb);
    of.jpeg_ms = PictureOf_ms(bench, maker, room, size, ImageFormat::kJpeg);
    of.depth_ms = PictureOf_ms(bench, maker, room, size, ImageFormat::kDepth);
    figures.renderer = maker.description();
    Serve(bench, files, of);
    figures.pictures.push_back(of);
  }
  return figures;
}

std::string Table(const SensorFigures& figures) {
  std::string table = fmt::format("{}; times of CPU of all threads, medians\n\n", figures.renderer);
  table +=
      fmt::format("{:<12}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>12}{:>10}\n", "a picture", "per s",
                  "draw ms", "read ms", "JPEG ms", "send ms", "depth ms", "served/s", "latency ms", "99 %");
  for (const PictureFigures& of : figures.pictures) {
    table += fmt::format(
        "{:<12}{:>10.0f}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.0f}{:>12.2f}{:>10.2f}\n",
        fmt::format("{} x {}", of.size.width, of.size.height), 1e3 / of.rgb_ms, of.rgb_ms - of.read_ms,
        of.read_ms, of.jpeg_ms - of.rgb_ms, of.served_ms - of.rgb_ms, of.depth_ms, 1e3 / of.served_ms,
        of.latency_ms, of.latency_99_ms);
  }
  const auto rows = [&table](const char* title, const std::vector<Row>& all, int digits) {
    table += fmt::format("\n{}\n", title);
    for (const Row& row : all) table += fmt::format("  {:<44}{:>10.{}f}\n", row.name, row.value, digits);
  };
  rows("million rays of a lidar per second", figures.rays, 2);
  rows("us per reading", figures.readings, 2);
  rows("us per robot-step, sensors that nobody reads", figures.unread, 2);
  return table;
}

std::string Json(const SensorFigures& figures) {
  boost::json::array pictures;
  for (const PictureFigures& of : figures.pictures) {
    pictures.push_back(boost::json::object{{"width", of.size.width},
                                           {"height", of.size.height},
                                           {"rgb_ms", of.rgb_ms},
                                           {"jpeg_ms", of.jpeg_ms},
                                           {"depth_ms", of.depth_ms},
                                           {"read_ms", of.read_ms},
                                           {"served_ms", of.served_ms},
                                           {"latency_ms", of.latency_ms},
                                           {"latency_99_ms", of.latency_99_ms}});
  }
  const auto object = [](const std::vector<Row>& rows) {
    boost::json::object values;
    for (const Row& row : rows) values[row.name] = row.value;
    return values;
  };
  return JsonText(boost::json::object{{"renderer", figures.renderer},
                                      {"pictures", pictures},
                                      {"million_rays_per_s", object(figures.rays)},
                                      {"us_per_reading", object(figures.readings)},
                                      {"us_per_robot_step", object(figures.unread)}}) +
         "\n";
}

}  // namespace

void AddBenchSensors(CLI::App& bench, std::function<int()>& chosen) {
  // The parser writes into it while the command lives.
  const auto given = std::make_shared<SensorBench>();
  const auto renderer = std::make_shared<std::string>("auto");
  CLI::App* sub = bench.add_subcommand(
      "sensors", "Pictures and lidar rays per second, time of each reading, latency of a picture");
  sub->footer("Example: coopdyn bench sensors --renderer egl");
  sub->add_option("--renderer", *renderer, "auto, osmesa or egl")
      ->check(CLI::IsMember({"auto", "osmesa", "egl"}))
      ->capture_default_str();
  sub->add_option("--seconds", given->seconds, "CPU seconds of each measurement")
      ->check(NumberIn(0.001, 1000))
      ->capture_default_str();
  sub->add_option("--repeats", given->repeats, "Measurements of which the median is told")
      ->check(WholeIn(1, 1000))
      ->capture_default_str();
  sub->add_option("--scenarios", given->folders, "A folder with robots");
  sub->add_flag("--json", given->json, "Print one JSON object instead of a table");
  sub->callback([given, renderer, &chosen] {
    given->renderer = *ParseRenderer(*renderer);
    chosen = [given] {
      SetRendererDefaults();
      const SensorFigures figures = Measure(*given);
      std::cout << (given->json ? Json(figures) : Table(figures)) << std::flush;
      return kExitOk;
    };
  });
}

}  // namespace coopdyn
