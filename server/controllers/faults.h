// SPDX-License-Identifier: MIT
// Checks whether a controller's output of a step is valid, and explains why not.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "clients/plugin/controller.h"

namespace coopdyn {

/// Whether a command is valid. Called twice per step and robot, so it makes no text.
inline bool IsFine(const coopdyn_command& command) {
  if (!std::isfinite(command.forward_m_s) || !std::isfinite(command.turn_rad_s)) return false;
  if (command.message_count > COOPDYN_MAX_MESSAGE || command.log_count > COOPDYN_MAX_LOGS) return false;
  return std::all_of(command.message, command.message + command.message_count,
                     [](double value) { return std::isfinite(value); });
}

/// Whether the set-point is valid for a channel that supports `modes`.
inline bool IsFine(const coopdyn_setpoint& setpoint, std::uint32_t modes) {
  return setpoint.mode <= COOPDYN_PWM && (modes >> setpoint.mode & 1) != 0 &&
         std::isfinite(setpoint.reference);
}

/// Whether the name and number can be logged, by the rules for clients.
bool IsFine(const coopdyn_logged& logged);
/// Whether the pose is valid.
bool IsFine(const coopdyn_move& move);

/// Describes what is invalid in an argument that is not fine; `joint`: the channel, with texts.
std::string Fault(const coopdyn_command& command);
std::string Fault(const coopdyn_setpoint& setpoint, const coopdyn_joint& joint);
std::string Fault(const coopdyn_logged& logged);
std::string Fault(const coopdyn_move& move);
/// The text for too many moves.
std::string TooManyMoves(std::size_t count);

}  // namespace coopdyn
