// SPDX-License-Identifier: MIT
#include "tests/bench/bench_arena.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coopdyn {

namespace {

std::string ArenaText(const ArenaOptions& options) {
  const double inner_m = std::round(std::sqrt(options.robots / options.density_m2) * 1e3) * 1e-3;  // whole mm
  std::string text =
      fmt::format("[SIMULATION]\nmode free\nseed {}\n", options.seed) +
      (options.walls ? WalledSquare(inner_m, 0.5) : fmt::format("[FLOOR]\nsize {0} {0} 0.1\n", 2 * inner_m)) +
      fmt::format("[SWARM_1]\ntype {}\nname bot\ncount {}\nfidelity {}\narea 0 0 {} {}\n", options.robot,
                  options.robots, ToString(options.fidelity), inner_m, inner_m);
  if (options.spacing_m > 0) text += fmt::format("spacing {}\n", options.spacing_m);
  if (!options.controller.empty()) text += "controller " + options.controller + "\n";
  if (options.boxes > 0) {
    text += fmt::format("[BOX]\ntype box\nsize 0.2 0.2 0.15\nmass 0.5\ncount {}\narea 0 0 {} {}\n",
                        options.boxes, inner_m, inner_m);
  }
  return text;
}

}  // namespace

std::string WalledSquare(double inner_m, double height_m) {
  constexpr double kWall_m = 0.1;
  const double outer_m = inner_m + 2 * kWall_m, middle_m = (inner_m + kWall_m) / 2;
  std::string text = fmt::format("[FLOOR]\nsize {} {} 0.1\n", outer_m, outer_m);
  const auto wall = [&](int number, double length_m, double width_m, double x_m, double y_m) {
    text += fmt::format("[WALL_{}]\ntype box\nsize {} {} {}\nposition {} {}\n", number, length_m, width_m,
                        height_m, x_m, y_m);
  };
  wall(1, outer_m, kWall_m, 0, middle_m);
  wall(2, outer_m, kWall_m, 0, -middle_m);
  wall(3, kWall_m, inner_m, middle_m, 0);
  wall(4, kWall_m, inner_m, -middle_m, 0);
  return text;
}

std::shared_ptr<const RobotModel> WithSensors(const RobotModel& model, std::optional<int> rays,
                                              std::optional<double> range_m) {
  auto changed = std::make_shared<RobotModel>(model);
  const auto is_distance = [](const SensorModel& sensor) {
    return std::holds_alternative<DistanceModel>(sensor.kind);
  };
  if (rays && *rays == 0) std::erase_if(changed->sensors, is_distance);
  const auto found = std::ranges::find_if(changed->sensors, is_distance);
  if (found == changed->sensors.end()) return changed;
  std::vector<SectorModel>& sensors = std::get<DistanceModel>(found->kind).sectors;
  if (rays) {
    const SectorModel first = sensors.front();
    // The sector from the first sensor's right edge to the last one's left edge, or the whole circle.
    const std::size_t count = sensors.size();
    const double gap = count > 1 ? sensors[1].bearing_rad - sensors[0].bearing_rad : first.opening_rad;
    const double width = std::max(gap, first.opening_rad);
    const double from = first.bearing_rad - width / 2;
    const double span =
        std::min(2 * std::numbers::pi, sensors.back().bearing_rad - first.bearing_rad + width);
    const double radius = first.X_RS.p.head<2>().norm();
    sensors.assign(static_cast<std::size_t>(*rays), first);
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const double b = WrapAngle(from + span * (static_cast<double>(i) + 0.5) / *rays);
      sensors[i].bearing_rad = b;
      sensors[i].opening_rad = 0;
      sensors[i].rays = 1;
      sensors[i].X_RS = {Vector3(radius * std::cos(b), radius * std::sin(b), first.X_RS.p.z()),
                         FromRollPitchYaw(0, 0, b)};
    }
    std::stable_sort(sensors.begin(), sensors.end(),
                     [](const auto& a, const auto& b) { return a.bearing_rad < b.bearing_rad; });
  }
  for (SectorModel& sensor : sensors) sensor.max_range_m = range_m.value_or(sensor.max_range_m);
  return changed;
}

std::shared_ptr<const Scenario> MakeArena(const ArenaOptions& options, RobotLibrary& library,
                                          Diagnostics& diagnostics) {
  const auto read = ReadScenario(ArenaText(options), "bench.scenario", library, false, diagnostics);
  if (read == nullptr || (!options.rays && !options.range_m)) return read;
  const RobotModel& model = *read->robots.front().model;
  if (model.sector_count() == 0) {
    diagnostics.Error({"bench.scenario", 0}, "a " + model.type +
                                                 " has no distance sensors to take the place of: leave "
                                                 "--rays and --range out");
    return nullptr;
  }
  auto scenario = std::make_shared<Scenario>(*read);
  const auto changed = WithSensors(model, options.rays, options.range_m);
  for (RobotEntry& robot : scenario->robots) robot.model = changed;
  return scenario;
}

}  // namespace coopdyn
