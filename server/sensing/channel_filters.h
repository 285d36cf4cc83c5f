// SPDX-License-Identifier: MIT
// Filters for the values of channels; their memory is stored in frames. Pure; any thread.
#pragma once

#include <span>

#include "server/state/frame.h"

namespace coopdyn {

/// Updates the turns counted for hinges by their rotation since the last step. `cells`: the channel's
/// measured values.
void CountTurns(const Frame& frame, int robot, const ChannelModel& model, std::span<double> cells);
/// Feeds the values of `frame`, the successor of `before`, to its filters, whose memory it already has.
void AdvanceFilters(const Frame& before, Frame& frame);

/// The filter's output; `otherwise` if the filter has no value yet.
double FilteredValue(const ValueFilter& filter, std::span<const double> cells, double otherwise);
/// Adds a value to the filter's memory; ignores non-finite values.
void TakeValue(const ValueFilter& filter, double value, double step_s, std::span<double> cells);

}  // namespace coopdyn
