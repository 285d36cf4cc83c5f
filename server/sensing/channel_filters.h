// SPDX-License-Identifier: MIT
// Filters of the values of channels: their memory goes from frame to frame. Pure; any thread.
#pragma once

#include <span>

#include "server/state/frame.h"

namespace coopdyn {

/// Gives the filters the values of `frame`, the one after `before`, whose memory it has.
/// Counts on by how far hinges have turned since the step before: `cells` of the channel's measured values.
void CountTurns(const Frame& frame, int robot, const ChannelModel& model, std::span<double> cells);
void AdvanceFilters(const Frame& before, Frame& frame);

/// What a filter puts out; `otherwise` if it has taken no value yet.
double FilteredValue(const ValueFilter& filter, std::span<const double> cells, double otherwise);
/// Takes a value into its memory. One that is not finite changes nothing.
void TakeValue(const ValueFilter& filter, double value, double step_s, std::span<double> cells);

}  // namespace coopdyn
