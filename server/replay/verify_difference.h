// SPDX-License-Identifier: MIT
// Finds what differs between two states, and words it. Pure functions.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "server/record/recorded_step.h"
#include "server/replay/verify.h"

namespace coopdyn {

/// A difference at the step of `frame`, with values of it.
Difference DifferenceAt(const Frame& frame, std::string what, std::string field, std::string recorded = {},
                        std::string repeated = {}, bool exact = true);

/// The first set-point, by channel, that differs in any bit from that in force in `repeated`. `looks_at`:
/// only channels of which it says so; null: all.
std::optional<Difference> FindSetpoint(std::span<const Setpoint> recorded, const Frame& repeated,
                                       const std::function<bool(std::size_t channel)>& looks_at = nullptr);
/// The first broadcast sent with the step of `repeated` that differs.
std::optional<Difference> FindMessage(std::span<const SentMessage> recorded, const Frame& repeated);
/// The first body that is further from its recorded pose than the rounding of poses explains.
std::optional<Difference> FindPose(std::span<const BodyState> recorded, const Frame& repeated);
/// The first thing that `step` shows (poses, channels, readings) that is not what a recorder makes of
/// `repeated`, whose exact state is the recorded one. What was not recorded is not compared.
std::optional<Difference> FindInRow(const RecordedStep& step, const Frame& repeated);
/// Both frames have the same numbers of bodies, channels and robots, and the same actuators.
bool CanCompare(const Frame& one, const Frame& other);
/// The first exact difference: set-points, bodies in order, solver, time; then what the hash does not cover,
/// motion of channels and broadcasts. @pre CanCompare()
std::optional<Difference> FindExact(const Frame& recorded, const Frame& repeated);

/// Appends `line`, if it is not empty, to lines of text.
void AddLine(const std::string& line, std::string& text);
/// Why the run of `reader` cannot be repeated.
std::string CannotLoadText(const RunReader& reader, const Diagnostics& diagnostics);

/// "with this step came in force: robot1 (0.5, 0.5 rad/s) …"; empty: none, or they are not of `scene`.
std::string CommandsOf(const RecordedStep& step, const Scene& scene);

}  // namespace coopdyn
