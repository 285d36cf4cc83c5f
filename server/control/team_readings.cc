// SPDX-License-Identifier: MIT
#include "server/control/team_readings.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "server/devices/module_core.h"
#include "server/model/values.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Robots per work unit of a thread.
constexpr std::size_t kGrain = 64;

struct Reading {
  const char* name;
  std::size_t (*columns)(const Scene& scene, std::size_t sensors, std::size_t nearest);
  void (*fill)(const Frame& frame, int robot, std::span<double> columns);
};

void FillPose(const Frame& frame, int robot, std::span<double> columns) {
  const Pose X_WR = RobotPose(frame, robot);
  columns[0] = X_WR.p.x();
  columns[1] = X_WR.p.y();
  columns[2] = Heading(X_WR.q);
}

void FillDistances(const Frame& frame, int robot, std::span<double> columns) {
  const std::span<const double> ranges_m = Distances(frame, robot);
  std::copy(ranges_m.begin(), ranges_m.end(), columns.begin());
  std::ranges::fill(columns.subspan(ranges_m.size()), kNan);
}

void FillTargets(const Frame& frame, int robot, std::span<double> columns) {
  for (std::size_t i = 0; i < columns.size(); i += 2) {
    columns[i] = kInf;
    columns[i + 1] = kNan;
  }
  for (const Sighting& seen : SeenTargets(frame, robot)) {
    const std::size_t at = 2 * static_cast<std::size_t>(seen.index);
    columns[at] = seen.distance_m;
    columns[at + 1] = seen.bearing_rad;
  }
}

void FillNeighbours(const Frame& frame, int robot, std::span<double> columns) {
  std::vector<Sighting> near = Neighbours(frame, robot);
  const std::size_t kept = std::min(near.size(), columns.size() / 3);
  // Sightings arrive by increasing id, i.e. index.
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(kept), near.end(),
                    [](const Sighting& a, const Sighting& b) {
                      return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.index < b.index;
                    });
  for (std::size_t i = 0; i < columns.size() / 3; ++i) {
    const bool is_there = i < kept;
    columns[3 * i] = is_there ? frame.scene->robots[static_cast<std::size_t>(near[i].index)].id.value : 0;
    columns[3 * i + 1] = is_there ? near[i].distance_m : kInf;
    columns[3 * i + 2] = is_there ? near[i].bearing_rad : kNan;
  }
}

void FillWheels(const Frame& frame, int robot, std::span<double> columns) {
  const int first = frame.scene->FindDrive(robot);
  if (first < 0) {
    std::ranges::fill(columns, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const ChannelState& wheel = frame.channels[static_cast<std::size_t>(first) + side];
    columns[side] = wheel.position;
    columns[2 + side] = wheel.velocity;
  }
}

void FillCompass(const Frame& frame, int robot, std::span<double> columns) {
  columns[0] = CompassHeading(frame, robot);
}

void FillSupport(const Frame& frame, int robot, std::span<double> columns) {
  const SupportReading reading = Support(frame, robot);
  columns[0] = reading.x_m;
  columns[1] = reading.y_m;
  columns[2] = reading.angle_rad;
}

void FillJoints(const Frame& frame, int robot, std::span<double> columns) {
  std::ranges::fill(columns, kNan);
  const SceneRobot& of = frame.scene->robots[static_cast<std::size_t>(robot)];
  for (int i = of.first_channel; i < of.first_channel + of.channel_count; ++i) {
    if (frame.scene->channels[static_cast<std::size_t>(i)].control < 0) continue;
    const ChannelState& channel = frame.channels[static_cast<std::size_t>(i)];
    columns[0] = channel.position;
    columns[1] = channel.velocity;
    columns[2] = channel.effort;
    columns = columns.subspan(3);
  }
}

std::size_t JointColumns(const Scene& scene, std::size_t /*sensors*/, std::size_t /*nearest*/) {
  int most = 0;
  for (const SceneRobot& robot : scene.robots) most = std::max(most, robot.control_count);
  return 3 * static_cast<std::size_t>(most);
}

template <std::size_t kCount>
std::size_t Fixed(const Scene& /*scene*/, std::size_t /*sensors*/, std::size_t /*nearest*/) {
  return kCount;
}

constexpr std::array<Reading, 8> kReadings{
    {{"pose", Fixed<3>, FillPose},
     {"distances", [](const Scene&, std::size_t sensors, std::size_t) { return sensors; }, FillDistances},
     {"targets", [](const Scene& scene, std::size_t, std::size_t) { return 2 * scene.targets.size(); },
      FillTargets},
     {"neighbours", [](const Scene&, std::size_t, std::size_t nearest) { return 3 * nearest; },
      FillNeighbours},
     {"wheels", Fixed<4>, FillWheels},
     {"compass", Fixed<1>, FillCompass},
     {"support", Fixed<3>, FillSupport},
     {"joints", JointColumns, FillJoints}}};
constexpr std::size_t kDistances = 1;

/// The sensor of `model` with module `name`; sensors.size() if there is none.
std::size_t FindSensor(const RobotModel& model, const std::string& name) {
  const auto found = std::ranges::find(model.sensors, name, &SensorModel::name);
  return static_cast<std::size_t>(found - model.sensors.begin());
}

/// Length of the longest reading of a module `name` in `scene`; 0: there is none of fixed length.
std::size_t ModuleColumns(const Scene& scene, const std::string& name) {
  std::size_t most = 0;
  const RobotModel* before = nullptr;
  for (const SceneRobot& robot : scene.robots) {
    const RobotModel& model = *robot.entry.model;
    const std::size_t sensor = &model == before ? model.sensors.size() : FindSensor(model, name);
    before = &model;
    if (sensor < model.sensors.size()) most = std::max(most, FixedCount(model.sensors[sensor].kind));
  }
  return most;
}

/// The names of all modules with readings of fixed length.
std::vector<std::string> ModuleNames(const Scene& scene) {
  std::vector<std::string> names;
  for (const SceneRobot& robot : scene.robots) {
    for (const SensorModel& sensor : robot.entry.model->sensors) {
      if (FixedCount(sensor.kind) > 0 && std::ranges::find(names, sensor.name) == names.end())
        names.push_back(sensor.name);
    }
  }
  return names;
}

void FillModule(const Frame& frame, int robot, const std::string& name, std::span<double> columns) {
  std::ranges::fill(columns, kNan);
  const RobotModel& model = ModelOf(frame, robot);
  const std::size_t sensor = FindSensor(model, name);
  if (sensor >= model.sensors.size()) return;
  FillFixed(frame, robot, sensor,
            columns.first(std::min(columns.size(), FixedCount(model.sensors[sensor].kind))));
}

}  // namespace

std::string TeamReadings::Select(std::string_view text, int nearest, const Scene& scene) {
  std::vector<Kind> kinds;
  for (const std::string& word : Words(text)) {
    const auto* const found = std::ranges::find(kReadings, word, &Reading::name);
    Kind kind = word;
    if (found != kReadings.end()) {
      kind = static_cast<std::size_t>(found - kReadings.begin());
    } else if (ModuleColumns(scene, word) == 0) {
      constexpr std::size_t kShown = 40;
      std::vector<std::string> names = ModuleNames(scene);
      for (const Reading& reading : kReadings) names.emplace_back(reading.name);
      return "there is no reading " + word.substr(0, kShown) +
             DidYouMean(word.size() > kShown ? "" : word, names);
    }
    if (std::ranges::find(kinds, kind) != kinds.end()) {
      return word + " is named twice: select_readings pose distances";
    }
    kinds.push_back(std::move(kind));
  }
  if (kinds.empty()) kinds = TeamReadings().kinds_;
  kinds_ = std::move(kinds);
  nearest_ = nearest;
  return {};
}

std::string TeamReadings::NameOf(const Kind& kind) {
  const auto* const place = std::get_if<std::size_t>(&kind);
  return place != nullptr ? kReadings[*place].name : std::get<std::string>(kind);
}

std::string TeamReadings::Names() const {
  std::string names;
  for (const Kind& kind : kinds_) names += (names.empty() ? "" : " ") + NameOf(kind);
  return names;
}

std::vector<std::int32_t> TeamReadings::Columns(const Scene& scene, std::size_t sensors) const {
  std::vector<std::int32_t> columns;
  for (const Kind& kind : kinds_) {
    const auto* const place = std::get_if<std::size_t>(&kind);
    const std::size_t count =
        place != nullptr ? kReadings[*place].columns(scene, sensors, static_cast<std::size_t>(nearest_))
                         : ModuleColumns(scene, std::get<std::string>(kind));
    columns.push_back(static_cast<std::int32_t>(count));
  }
  return columns;
}

void TeamReadings::Fill(const Frame& frame, std::span<const int> robots, std::size_t sensors,
                        WorkerPool& pool, std::span<double> data) const {
  const std::vector<std::int32_t> widths = Columns(*frame.scene, sensors);
  const auto width = static_cast<std::size_t>(std::accumulate(widths.begin(), widths.end(), 0));
  if (std::ranges::find(kinds_, Kind(kDistances)) != kinds_.end() && sensors > 0) {
    std::vector<int> present;
    const bool some_gone = std::find(robots.begin(), robots.end(), -1) != robots.end();
    if (some_gone) {
      std::copy_if(robots.begin(), robots.end(), std::back_inserter(present),
                   [](int robot) { return robot >= 0; });
    }
    PrepareDistances(frame, some_gone ? std::span<const int>(present) : robots, pool);
  }
  pool.For(robots.size(), kGrain, [&](std::size_t first, std::size_t end) {
    for (std::size_t row = first; row < end; ++row) {
      std::span<double> left = data.subspan(row * width, width);
      if (robots[row] < 0) {
        std::fill(left.begin(), left.end(), kNan);
        continue;
      }
      for (std::size_t i = 0; i < kinds_.size(); ++i) {
        const auto columns = static_cast<std::size_t>(widths[i]);
        if (const auto* const place = std::get_if<std::size_t>(&kinds_[i])) {
          kReadings[*place].fill(frame, robots[row], left.first(columns));
        } else {
          FillModule(frame, robots[row], std::get<std::string>(kinds_[i]), left.first(columns));
        }
        left = left.subspan(columns);
      }
    }
  });
}

}  // namespace coopdyn
