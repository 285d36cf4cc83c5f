// SPDX-License-Identifier: MIT
#include "server/controllers/faults.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <string_view>

#include "server/base/printable.h"
#include "server/model/section_reader.h"
#include "server/state/run_control.h"

namespace coopdyn {

namespace {

const char* ModeName(std::size_t mode) {
  constexpr std::array kNames = {"off", "position", "direct", "velocity", "effort", "pwm"};
  return kNames[mode];
}

}  // namespace

bool IsFine(const coopdyn_logged& logged) {
  const std::string_view name(logged.name, strnlen(logged.name, COOPDYN_MAX_NAME));
  return name.size() < COOPDYN_MAX_NAME && IsLogName(name) && std::isfinite(logged.value);
}

bool IsFine(const coopdyn_move& move) {
  const auto far = [](double value) { return !(std::abs(value) <= kMaxFileLength_m); };
  if (std::ranges::any_of(move.pose.p_m, far)) return false;
  const double* q = move.pose.q;
  return std::abs(std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) - 1) < 1e-3;
}

std::string Fault(const coopdyn_logged& logged) {
  const std::string name(logged.name, strnlen(logged.name, COOPDYN_MAX_NAME - 1));
  if (!std::isfinite(logged.value) && IsLogName(name))
    return fmt::format("logged {} = {}: it must be a finite number", name, logged.value);
  return fmt::format("logged '{}': a name is a letter, then letters, digits and _, at most {}",
                     Printable(name), COOPDYN_MAX_NAME - 1);
}

std::string Fault(const coopdyn_move& move) {
  return fmt::format(
      "moves {} to {} {} {}, quaternion {} {} {} {}: a place is within 100 km of the origin, a quaternion "
      "has "
      "length 1, for example 1 0 0 0",
      move.id, move.pose.p_m[0], move.pose.p_m[1], move.pose.p_m[2], move.pose.q[0], move.pose.q[1],
      move.pose.q[2], move.pose.q[3]);
}

std::string TooManyMoves(std::size_t count) {
  return fmt::format("moves {} things in one step: at most {}", count, COOPDYN_MAX_MOVES);
}

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
  if (command.log_count > COOPDYN_MAX_LOGS) {
    return fmt::format("logged {} numbers in one step: at most {}", command.log_count, COOPDYN_MAX_LOGS);
  }
  return {};
}

std::string Fault(const coopdyn_setpoint& setpoint, const coopdyn_joint& joint) {
  const std::string channel = fmt::format("{}/{}", joint.module, joint.name);
  if (setpoint.mode > COOPDYN_PWM) {
    return fmt::format("returned mode {} for {}: there is no such mode, use enum coopdyn_mode", setpoint.mode,
                       channel);
  }
  if ((joint.modes >> setpoint.mode & 1) == 0) {
    std::string modes;
    for (std::size_t mode = 0; mode <= COOPDYN_PWM; ++mode) {
      if ((joint.modes >> mode & 1) != 0) modes += (modes.empty() ? "" : ", ") + std::string(ModeName(mode));
    }
    return fmt::format("returned mode {} for {}, which takes: {}", ModeName(setpoint.mode), channel, modes);
  }
  return fmt::format("returned reference = {} for {}: it must be a finite number", setpoint.reference,
                     channel);
}

}  // namespace coopdyn
