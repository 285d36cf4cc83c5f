// SPDX-License-Identifier: MIT
// Exact codecs for bodies, channels and joints of a frame, for both directions (server/base/bytes.h). Pure.
#pragma once

#include <cstddef>

#include "server/base/bytes.h"
#include "server/state/frame.h"

namespace coopdyn {

inline constexpr std::size_t kBodyBytes = (3 + 4 + 9 + 3 + 3) * 8 + 8;
inline constexpr std::size_t kSetpointBytes = 1 + 8, kChannelStateBytes = 2 * 8 + kSetpointBytes;

/// u8 mode, f64 reference.
void CodeSetpoint(auto& codec, auto& setpoint) {
  codec.Word(setpoint.mode, ControlMode::kPwm);
  codec.Finite(setpoint.reference);
}

void CodeBody(auto& codec, auto& body) {
  codec.Finite(body.p_WB);
  codec.Finite(body.q_WB);
  codec.Finite(body.R_WB);
  codec.Finite(body.v_WB);
  codec.Finite(body.w_WB);
  codec.Number(body.sleep_counter);
}

void CodeChannel(auto& codec, auto& channel, bool has_effort = false) {
  codec.Finite(channel.position);
  codec.Finite(channel.velocity);
  if (has_effort) codec.Number(channel.effort);  // may be nan
  CodeSetpoint(codec, channel.setpoint);
}

void CodeControl(auto& codec, auto& control, bool has_acceleration = true) {
  codec.Number(control.stiffness);  // may be infinite
  codec.Finite(control.damping);
  codec.Finite(control.offset);
  codec.Finite(control.speed);
  codec.Finite(control.acceleration);
  codec.Finite(control.p);
  codec.Finite(control.i);
  codec.Finite(control.d);
  codec.Finite(control.start);
  codec.Finite(control.start_velocity);
  if (has_acceleration) codec.Finite(control.start_acceleration);
  codec.Finite(control.target);
  codec.Finite(control.duration_s);
  codec.Finite(control.elapsed_s);
  codec.Finite(control.integral);
  codec.Finite(control.reference);
}

void CodeDriveTrain(auto& codec, auto& train) {
  codec.Finite(train.rotor_rad);
  codec.Finite(train.rotor_rad_s);
  codec.Finite(train.current_a);
  codec.Finite(train.energy_j);
}

}  // namespace coopdyn
