// SPDX-License-Identifier: MIT
#include "server/control/team_readings.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "server/devices/module_core.h"
#include "server/model/values.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Robots that one thread takes at a time.
constexpr std::size_t kGrain = 64;

}  // namespace

const std::vector<std::string>& TeamReadings::Words() {
  static const std::vector<std::string> words = {"pose",       "distances", "targets",
                                                 "neighbours", "wheels",    "compass"};
  return words;
}

std::string TeamReadings::Select(std::string_view text, int nearest) {
  std::vector<Kind> kinds;
  for (const std::string& word : coopdyn::Words(text)) {
    const auto found = std::find(Words().begin(), Words().end(), word);
    if (found == Words().end()) {
      constexpr std::size_t kShown = 40;
      return "there is no reading " + word.substr(0, kShown) +
             DidYouMean(word.size() > kShown ? "" : word, Words());
    }
    const auto kind = static_cast<Kind>(found - Words().begin());
    if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) {
      return word + " is named twice: select_readings pose distances";
    }
    kinds.push_back(kind);
  }
  if (kinds.empty()) kinds = TeamReadings().kinds_;
  kinds_ = std::move(kinds);
  nearest_ = nearest;
  return {};
}

std::string TeamReadings::Names() const {
  std::string names;
  for (const Kind kind : kinds_) {
    if (!names.empty()) names += ' ';
    names += Words()[static_cast<std::size_t>(kind)];
  }
  return names;
}

std::size_t TeamReadings::ColumnsOf(Kind kind, const Scene& scene, std::size_t sensors) const {
  switch (kind) {
    case Kind::kPose:
      return 3;
    case Kind::kDistances:
      return sensors;
    case Kind::kTargets:
      return 2 * scene.targets.size();
    case Kind::kNeighbours:
      return 3 * static_cast<std::size_t>(nearest_);
    case Kind::kWheels:
      return 4;
    case Kind::kCompass:
      return 1;
  }
  return 0;
}

std::vector<std::int32_t> TeamReadings::Columns(const Scene& scene, std::size_t sensors) const {
  std::vector<std::int32_t> columns;
  for (const Kind kind : kinds_)
    columns.push_back(static_cast<std::int32_t>(ColumnsOf(kind, scene, sensors)));
  return columns;
}

void TeamReadings::Fill(const Frame& frame, std::span<const int> robots, std::size_t sensors,
                        WorkerPool& pool, std::span<double> data) const {
  std::vector<std::pair<Kind, std::size_t>> parts;  // with their widths
  std::size_t width = 0;
  for (const Kind kind : kinds_) {
    parts.emplace_back(kind, ColumnsOf(kind, *frame.scene, sensors));
    width += parts.back().second;
  }
  if (std::find(kinds_.begin(), kinds_.end(), Kind::kDistances) != kinds_.end() && sensors > 0) {
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
      for (const auto& [kind, columns] : parts) {
        FillOne(kind, frame, robots[row], left.first(columns));
        left = left.subspan(columns);
      }
    }
  });
}

void TeamReadings::FillOne(Kind kind, const Frame& frame, int robot, std::span<double> columns) const {
  switch (kind) {
    case Kind::kPose: {
      const Pose X_WR = RobotPose(frame, robot);
      columns[0] = X_WR.p.x();
      columns[1] = X_WR.p.y();
      columns[2] = Heading(X_WR.q);
      return;
    }
    case Kind::kDistances: {
      const std::span<const double> ranges_m = Distances(frame, robot);
      std::copy(ranges_m.begin(), ranges_m.end(), columns.begin());
      std::fill(columns.begin() + static_cast<std::ptrdiff_t>(ranges_m.size()), columns.end(), kNan);
      return;
    }
    case Kind::kTargets:
      for (std::size_t i = 0; i < columns.size(); i += 2) {
        columns[i] = kInf;
        columns[i + 1] = kNan;
      }
      for (const Sighting& seen : SeenTargets(frame, robot)) {
        const std::size_t at = 2 * static_cast<std::size_t>(seen.index);
        columns[at] = seen.distance_m;
        columns[at + 1] = seen.bearing_rad;
      }
      return;
    case Kind::kNeighbours:
      FillNeighbours(frame, robot, columns);
      return;
    case Kind::kCompass:
      columns[0] = CompassHeading(frame, robot);
      return;
    case Kind::kWheels: {
      const int first = frame.scene->FindDrive(robot);
      if (first < 0) {
        std::ranges::fill(columns, 0);
        return;
      }
      for (std::size_t side = 0; side < 2; ++side) {
        const ChannelState& wheel = frame.channels[static_cast<std::size_t>(first) + side];
        columns[side] = wheel.position;
        columns[2 + side] = wheel.velocity;
      }
      return;
    }
  }
}

void TeamReadings::FillNeighbours(const Frame& frame, int robot, std::span<double> columns) const {
  std::vector<Sighting> near = Neighbours(frame, robot);
  const std::size_t kept = std::min(near.size(), columns.size() / 3);
  // They come by increasing id, which is the order of their indices.
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

}  // namespace coopdyn
