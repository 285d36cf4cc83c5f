// SPDX-License-Identifier: MIT
#include "tests/bench/sensor_room.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "server/geometry/mesh.h"
#include "server/model/readers.h"
#include "tests/bench/bench_arena.h"

namespace coopdyn {

namespace {

constexpr const char* kType = "bench_turtle";
constexpr double kRoom_m = 12;

constexpr std::string_view kComputedSensors = R"(
    <coopdyn:lidar link="lidar" max_range="30"/>
    <coopdyn:lidar name="lidar_3d" link="lidar" rows="16" first_elevation_deg="-15" last_elevation_deg="15" max_range="30"/>
    <coopdyn:distance_sensors radius="0.18" height="0.1" max_range="4" opening_deg="15" rays="5" noise_stddev="0.005">
      <coopdyn:sector bearing_deg="-60"/><coopdyn:sector bearing_deg="-20"/>
      <coopdyn:sector bearing_deg="20"/><coopdyn:sector bearing_deg="60"/>
    </coopdyn:distance_sensors>
    <coopdyn:sonar max_range="4" noise_stddev="0.005"><coopdyn:beam link="chassis" pose="0.18 0 0.1 0 0 0"/></coopdyn:sonar>
    <coopdyn:infrared preset="gp2d12"><coopdyn:eye link="chassis" pose="0.18 0 0.1 0 0 0"/></coopdyn:infrared>
    <coopdyn:light opening_deg="90" noise_stddev="0.01"><coopdyn:eye link="chassis" pose="0.18 0 0.1 0 0 0"/></coopdyn:light>
    <coopdyn:target_sensor distance_noise_stddev="0.01"/>
    <coopdyn:neighbours range="4" distance_noise_stddev="0.01"/>
    <coopdyn:compass noise_stddev_deg="1"/>
    <coopdyn:module type="lidar"/>
    <coopdyn:module type="lidar" name="lidar_3d"/>
    <coopdyn:module type="distance"/>
    <coopdyn:module type="sonar"/>
    <coopdyn:module type="infrared"/>
    <coopdyn:module type="light"/>
    <coopdyn:module type="target"/>
    <coopdyn:module type="neighbours"/>
    <coopdyn:module type="compass"/>
)";
constexpr std::string_view kMeasuredSensors = R"(
    <coopdyn:imu link="chassis" turn_noise_stddev="0.003" acceleration_noise_stddev="0.02" orientation_noise_stddev_deg="0.2"/>
    <coopdyn:wrench joint="camera_mount" force_noise_stddev="0.01" torque_noise_stddev="0.001"/>
    <coopdyn:contact threshold="0.5"><coopdyn:zone bearing_deg="0" opening_deg="60"/></coopdyn:contact>
    <coopdyn:odometry resolution_deg="0.13963" slip_stddev="0.02"/>
    <coopdyn:battery capacity="117000" idle="6" efficiency="0.6"/>
    <coopdyn:module type="imu"/>
    <coopdyn:module type="wrench"/>
    <coopdyn:module type="contact"/>
    <coopdyn:module type="odometry"/>
    <coopdyn:module type="battery"/>
)";

/// Three rings of things around the centre, two lamps and a red target.
std::string Room(int robots) {
  std::string text = "[SIMULATION]\nmode lockstep\n" + WalledSquare(kRoom_m, 1) +
                     "[LIGHT_1]\nposition 2 2 2\npower 3\n[LIGHT_2]\nposition -2 1 2\npower 3\n"
                     "[TARGET]\nred 3.7 0.5 0.3\n";
  constexpr int kRings = 3, kInRing = 20;
  for (int i = 0; i < kRings * kInRing; ++i) {
    const double radius_m = 2.2 + 1.2 * (i % kRings);
    const double angle_rad = 2 * std::numbers::pi * (i + 0.3) / (kRings * kInRing);
    constexpr std::array kShapes{"type box\nsize 0.25 0.2 0.5", "type cylinder\nsize 0.24 0.24 0.6",
                                 "type sphere\nsize 0.3"};
    constexpr std::array kColors{"red", "green", "blue", "orange", "yellow"};
    text += fmt::format("[THING_{}]\n{}\nposition {} {}\ncolor {}\n", i + 1,
                        kShapes[static_cast<std::size_t>(i / kRings) % kShapes.size()],
                        radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad),
                        kColors[static_cast<std::size_t>(i) % kColors.size()]);
  }
  for (int i = 0; i < robots; ++i) {
    const double angle_rad = 2.4 * i;  // the golden angle: a spiral
    const double radius_m = i == 0 ? 0 : 0.35 * std::sqrt(i + 2);
    text += fmt::format("[ROBOT_{}]\ntype {}\nname robot{}\nposition {} {}\n", i + 1, kType, i + 1,
                        radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad));
  }
  return text;
}

}  // namespace

std::string TurtleWith(Sensors sensors, const SearchPath& path) {
  const auto file = path.FindRobot("turtle");
  if (!file)
    throw std::runtime_error("there is no robot turtle: name the folder of robots/ with --scenarios");
  std::ifstream stream(*file, std::ios::binary);
  std::string model{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t drive = model.find("<coopdyn:drive");
  const std::size_t begin = drive == std::string::npos ? drive : model.find("/>", drive);
  const std::size_t end = model.find("</model>");
  if (begin == std::string::npos || end == std::string::npos)
    throw std::runtime_error(file->string() + " is not the turtle that comes with coopdyn");
  std::string added = "/>\n";
  if (sensors != Sensors::kNone) {
    added += kComputedSensors;
    for (const CameraSize& size : kCameraSizes) {
      added += fmt::format(
          "<coopdyn:camera name=\"{0}\" link=\"camera\" pose=\"0.02 0 0 0 0 0\" width=\"{1}\" "
          "height=\"{2}\"/>"
          "<coopdyn:module type=\"camera\" name=\"{0}\"/>\n",
          size.module, size.width, size.height);
    }
  }
  if (sensors == Sensors::kAll) added += kMeasuredSensors;
  added += "<coopdyn:module type=\"motors\"/><coopdyn:module type=\"pose\"/>\n";
  return model.replace(begin, end - begin, added);
}

std::map<std::string, std::string> RoomFiles(Sensors sensors, int robots, const SearchPath& path) {
  return {{fmt::format("robots/{}/model.sdf", kType), TurtleWith(sensors, path)},
          {"bench.scenario", Room(robots)}};
}

std::shared_ptr<const Scene> RoomOf(const std::map<std::string, std::string>& files, const SearchPath& path) {
  RobotLibrary library(path);
  Diagnostics diagnostics;
  for (const auto& [name, text] : files) {
    if (!name.ends_with(".sdf")) continue;
    if (auto model = ReadRobotModelText(text, name, kType, diagnostics)) library.Add(kType, std::move(model));
  }
  const auto scenario =
      ReadScenario(files.at("bench.scenario"), "bench.scenario", library, false, diagnostics);
  if (scenario == nullptr) throw std::runtime_error(diagnostics.ToString());
  return MakeScene(scenario);
}

std::shared_ptr<const Scene> HillsAround(const Scene& room) {
  constexpr std::uint32_t kSide = 224;  // squares, two triangles each
  constexpr double kSpacing_m = 0.1;
  std::vector<Vector3> vertices;
  std::vector<MeshData::Triangle> triangles;
  for (std::uint32_t i = 0; i <= kSide; ++i) {
    for (std::uint32_t k = 0; k <= kSide; ++k) {
      const double x = kSpacing_m * (i - kSide / 2.0), y = kSpacing_m * (k - kSide / 2.0);
      // A bowl, so that all rays hit something.
      vertices.emplace_back(x, y, 0.2 * std::sin(2 * x) * std::sin(3 * y) + 0.08 * (x * x + y * y));
      if (i == kSide || k == kSide) continue;
      const std::uint32_t at = i * (kSide + 1) + k, next = at + kSide + 1;
      triangles.push_back({at, next, next + 1});
      triangles.push_back({at, next + 1, at + 1});
    }
  }
  auto scenario = std::make_shared<Scenario>();
  scenario->robots.push_back(room.scenario->robots.front());
  auto model = std::make_shared<RobotModel>(*scenario->robots.front().model);
  WorldObject hills;
  hills.name = "HILLS";
  model->meshes.push_back(
      std::make_shared<MeshData>(MakeMesh(std::move(vertices), std::move(triangles), hills.X_WO.p)));
  hills.shape = Mesh{model->meshes.back().get()};  // owned by the robot's model
  hills.X_WO.p.z() -= 0.3;
  scenario->robots.front().model = std::move(model);
  scenario->objects.push_back(std::move(hills));
  return MakeScene(std::move(scenario));
}

std::vector<std::unique_ptr<const Frame>> FramesOf(const std::shared_ptr<const Scene>& scene, int count) {
  std::vector<std::unique_ptr<const Frame>> frames;
  for (int i = 0; i < count; ++i) {
    auto frame = std::make_unique<Frame>();
    frame->scene = scene;
    frame->seed = 1;
    frame->step = static_cast<std::uint64_t>(i);
    frame->bodies.resize(scene->body_ids.size());
    frame->channels.resize(scene->channels.size());
    frame->measured.resize(static_cast<std::size_t>(scene->measured_count));
    for (const SceneRobot& robot : scene->robots) {
      Pose X_WR = robot.entry.X_WR;
      if (&robot == &scene->robots.front())
        X_WR = {X_WR.p + Vector3(0.01 * (i % 20), 0, 0), FromRollPitchYaw(0, 0, 0.05 * i)};
      for (int k = 0; k < robot.body_count; ++k) {
        const LinkModel& link = robot.entry.model->links[static_cast<std::size_t>(k)];
        const Pose X_WB = robot.one_body() ? X_WR * robot.X_BR.Inverse() : X_WR * link.X_RL * link.X_LI;
        BodyState& body = frame->bodies[static_cast<std::size_t>(robot.first_body + k)];
        body.p_WB = X_WB.p;
        body.q_WB = {X_WB.q.w(), X_WB.q.x(), X_WB.q.y(), X_WB.q.z()};
        Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(body.R_WB.data()) =
            X_WB.q.toRotationMatrix();
      }
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace coopdyn
