// SPDX-License-Identifier: MIT
// For tests whose robots have only a two-wheel drive: wheels left, right; rad/s.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/model/drive.h"
#include "server/state/frame.h"

namespace coopdyn {

inline std::array<Setpoint, 2> Wheels(double left_rad_s, double right_rad_s) {
  return SetpointsFor({left_rad_s, right_rad_s});
}

/// Set-points of all channels, robot by robot.
inline std::vector<WheelSpeeds> ByRobot(std::span<const Setpoint> setpoints) {
  std::vector<WheelSpeeds> wheels;
  for (std::size_t i = 0; i + 1 < setpoints.size(); i += 2) {
    wheels.push_back({setpoints[i].reference, setpoints[i + 1].reference});
  }
  return wheels;
}

inline std::vector<Setpoint> ByChannel(std::span<const WheelSpeeds> wheels) {
  std::vector<Setpoint> setpoints;
  for (const WheelSpeeds& of : wheels) setpoints.insert(setpoints.end(), {{of[0]}, {of[1]}});
  return setpoints;
}

/// Set-points of a robot's wheels, their angles (rad) and speeds.
inline WheelSpeeds SetpointOf(const Frame& frame, int robot) {
  const auto channels = ChannelsOf(frame, robot);
  return {channels[0].setpoint.reference, channels[1].setpoint.reference};
}
inline std::array<double, 2> AnglesOf(const Frame& frame, int robot) {
  const auto channels = ChannelsOf(frame, robot);
  return {channels[0].position, channels[1].position};
}
inline WheelSpeeds SpeedsOf(const Frame& frame, int robot) {
  const auto channels = ChannelsOf(frame, robot);
  return {channels[0].velocity, channels[1].velocity};
}

inline void SetSetpoint(Frame& frame, int robot, const WheelSpeeds& setpoint_rad_s) {
  for (std::size_t side = 0; side < 2; ++side) {
    frame.channels[2 * static_cast<std::size_t>(robot) + side].setpoint = {setpoint_rad_s[side]};
  }
}
inline void SetTurned(Frame& frame, int robot, const std::array<double, 2>& angle_rad,
                      const WheelSpeeds& speed_rad_s) {
  for (std::size_t side = 0; side < 2; ++side) {
    ChannelState& wheel = frame.channels[2 * static_cast<std::size_t>(robot) + side];
    wheel.position = angle_rad[side];
    wheel.velocity = speed_rad_s[side];
  }
}

}  // namespace coopdyn
