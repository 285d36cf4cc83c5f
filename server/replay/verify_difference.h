// SPDX-License-Identifier: MIT
// Finds and describes differences between two states. Pure functions.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "server/record/recorded_step.h"
#include "server/replay/verify.h"

namespace coopdyn {

/// A difference at the step of `frame`, with values of that step.
Difference DifferenceAt(const Frame& frame, std::string what, std::string field, std::string recorded = {},
                        std::string repeated = {}, bool exact = true);

/// The first set-point, by channel, that differs in any bit from the one in force in `repeated`. `looks_at`
/// selects channels; null: all.
std::optional<Difference> FindSetpoint(std::span<const Setpoint> recorded, const Frame& repeated,
                                       const std::function<bool(std::size_t channel)>& looks_at = nullptr);
/// The first broadcast sent with the step of `repeated` that differs.
std::optional<Difference> FindMessage(std::span<const SentMessage> recorded, const Frame& repeated);
/// The first body farther from its recorded pose than the rounding of poses explains.
std::optional<Difference> FindPose(std::span<const BodyState> recorded, const Frame& repeated);
/// The first value of `step` (poses, channels, readings) that differs from what a recorder would write for
/// `repeated`, whose exact state is the recorded one. Compares recorded parts only.
std::optional<Difference> FindInRow(const RecordedStep& step, const Frame& repeated);
/// Whether both frames have the same numbers of bodies, channels and robots, and the same actuators.
bool CanCompare(const Frame& one, const Frame& other);
/// The first exact difference: set-points, bodies in order, solver, time; then motion of channels and
/// broadcasts, which the hash does not cover. @pre CanCompare()
std::optional<Difference> FindExact(const Frame& recorded, const Frame& repeated);

/// Appends `line` to lines of `text` unless it is empty.
void AddLine(const std::string& line, std::string& text);
/// Why the run of `reader` cannot be repeated.
std::string CannotLoadText(const RunReader& reader, const Diagnostics& diagnostics);

/// "set-points that came in force with step N: robot1 (0.5, 0.5 rad/s) …"; empty without commands or if they
/// do not fit `scene`.
std::string CommandsOf(const RecordedStep& step, const Scene& scene);

}  // namespace coopdyn
