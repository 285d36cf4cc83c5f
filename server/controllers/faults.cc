// SPDX-License-Identifier: MIT
#include "server/controllers/faults.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cstddef>

namespace coopdyn {

namespace {

const char* ModeName(std::size_t mode) {
  constexpr std::array kNames = {"off", "position", "direct", "velocity", "effort"};
  return kNames[mode];
}

}  // namespace

std::string Fault(const coopdyn_command& command) {
  const auto not_finite = [](const char* what, double value) {
    return fmt::format("returned {} = {}: it must be a finite number", what, value);
  };
  if (!std::isfinite(command.forward_m_s)) return not_finite("forward_m_s", command.forward_m_s);
  if (!std::isfinite(command.turn_rad_s)) return not_finite("turn_rad_s", command.turn_rad_s);
  if (command.message_count > COOPDYN_MAX_MESSAGE) {
    return fmt::format("returned message_count = {}: at most {}", command.message_count, COOPDYN_MAX_MESSAGE);
  }
  for (std::uint32_t i = 0; i < command.message_count; ++i) {
    if (!std::isfinite(command.message[i])) return not_finite("a number in message", command.message[i]);
  }
  return {};
}

std::string Fault(const coopdyn_setpoint& setpoint, const coopdyn_joint& joint) {
  const std::string channel = fmt::format("{}/{}", joint.module, joint.name);
  if (setpoint.mode > COOPDYN_EFFORT) {
    return fmt::format("returned mode {} for {}: there is no such mode, use enum coopdyn_mode", setpoint.mode,
                       channel);
  }
  if ((joint.modes >> setpoint.mode & 1) == 0) {
    std::string modes;
    for (std::size_t mode = 0; mode <= COOPDYN_EFFORT; ++mode) {
      if ((joint.modes >> mode & 1) != 0) modes += (modes.empty() ? "" : ", ") + std::string(ModeName(mode));
    }
    return fmt::format("returned mode {} for {}, which takes: {}", ModeName(setpoint.mode), channel, modes);
  }
  return fmt::format("returned reference = {} for {}: it must be a finite number", setpoint.reference,
                     channel);
}

}  // namespace coopdyn
