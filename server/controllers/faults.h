// SPDX-License-Identifier: MIT
// Whether what a controller gave in a step can be carried out, and if not, why.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "clients/plugin/controller.h"

namespace coopdyn {

/// Whether a command can be carried out. Asked twice for each step of each robot, so without a text.
inline bool IsFine(const coopdyn_command& command) {
  if (!std::isfinite(command.forward_m_s) || !std::isfinite(command.turn_rad_s)) return false;
  if (command.message_count > COOPDYN_MAX_MESSAGE || command.log_count > COOPDYN_MAX_LOGS) return false;
  return std::all_of(command.message, command.message + command.message_count,
                     [](double value) { return std::isfinite(value); });
}

/// Whether a channel that takes `modes` can carry it out.
inline bool IsFine(const coopdyn_setpoint& setpoint, std::uint32_t modes) {
  return setpoint.mode <= COOPDYN_PWM && (modes >> setpoint.mode & 1) != 0 &&
         std::isfinite(setpoint.reference);
}

/// Whether it can be logged, as a client's number.
bool IsFine(const coopdyn_logged& logged);
/// Whether the pose is one.
bool IsFine(const coopdyn_move& move);

/// What is wrong with one that is not fine; `joint`: its channel, with texts.
std::string Fault(const coopdyn_command& command);
std::string Fault(const coopdyn_setpoint& setpoint, const coopdyn_joint& joint);
std::string Fault(const coopdyn_logged& logged);
std::string Fault(const coopdyn_move& move);
/// Of too many moves.
std::string TooManyMoves(std::size_t count);

}  // namespace coopdyn
