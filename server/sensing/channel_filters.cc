// SPDX-License-Identifier: MIT
#include "server/sensing/channel_filters.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "server/base/portable_math.h"
#include "server/sensing/readings.h"

namespace coopdyn {

double FilteredValue(const ValueFilter& filter, std::span<const double> cells, double otherwise) {
  if (cells.empty() || cells.front() < 1) return otherwise;
  if (filter.kind == ValueFilter::Kind::kLowPass) return cells[1];
  const auto taken = cells.subspan(1, static_cast<std::size_t>(cells.front()));
  if (filter.kind == ValueFilter::Kind::kMean)
    return std::accumulate(taken.begin(), taken.end(), 0.0) / static_cast<double>(taken.size());
  std::vector<double> sorted(taken.begin(), taken.end());
  std::ranges::sort(sorted);
  const std::size_t middle = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

void TakeValue(const ValueFilter& filter, double value, double step_s, std::span<double> cells) {
  if (!std::isfinite(value)) return;
  if (filter.kind == ValueFilter::Kind::kLowPass) {
    const bool is_first = cells[0] < 1;
    // Exact for a value that is constant during the step.
    cells[1] = is_first ? value : value + (cells[1] - value) * portable::Exp(-step_s / filter.time_s);
    cells[0] = 1;
    return;
  }
  std::shift_right(cells.begin() + 1, cells.end(), 1);
  cells[1] = value;
  cells[0] = std::min(cells[0] + 1, static_cast<double>(filter.steps));
}

void AdvanceFilters(const Frame& before, Frame& frame) {
  const Scene& scene = *frame.scene;
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const RobotModel& model = *scene.robots[i].entry.model;
    const int robot = static_cast<int>(i);
    for (std::size_t sensor = 0; sensor < model.sensors.size(); ++sensor) {
      const auto* const channel = std::get_if<ChannelModel>(&model.sensors[sensor].kind);
      if (channel == nullptr || !channel->remembers()) continue;
      const std::size_t first =
          static_cast<std::size_t>(scene.robots[i].first_measured) + model.FirstMeasured(sensor);
      const std::span<double> measured = std::span(frame.measured).subspan(first, channel->cells());
      CountTurns(frame, robot, *channel, measured);
      const std::vector<double> raw = UnfilteredValues(frame, robot, model.NumberOf(sensor));
      std::vector<double> start;  // a filter starts with the previous frame's value
      for (std::size_t k = 0; k < channel->values.size(); ++k) {
        const ChannelModel::Value& value = channel->values[k];
        if (!value.is_filtered()) continue;
        const std::span<double> cells = value.FilterCells(measured);
        const double step_s = ToSeconds(frame.step_length);
        if (cells[0] < 1 && before.scene == frame.scene) {
          if (start.empty()) start = UnfilteredValues(before, robot, model.NumberOf(sensor));
          TakeValue(value.filter, start[k], step_s, cells);
        }
        TakeValue(value.filter, raw[k], step_s, cells);
      }
    }
  }
}

}  // namespace coopdyn
