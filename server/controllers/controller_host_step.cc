// SPDX-License-Identifier: MIT
// ControllerHost::Step(): checks the controllers' commands again and turns them into set-points.
#include <algorithm>
#include <cmath>
#include <variant>

#include "server/base/printable.h"
#include "server/controllers/controller_host.h"
#include "server/controllers/faults.h"
#include "server/model/drive.h"
#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

/// Scales both wheels by the same factor, as for forward and turn. @pre velocities, the only mode of a drive
void LimitSpeeds(const DriveModel& drive, std::span<Setpoint> wheels) {
  double factor = 1;
  const WheelSpeeds speeds = LimitWheels(drive, {wheels[0].reference, wheels[1].reference}, factor);
  wheels[0].reference = speeds[0];
  wheels[1].reference = speeds[1];
}

void LimitJoints(const RobotModel& model, const ActuatorModel& board, std::span<Setpoint> setpoints) {
  for (std::size_t i = 0; i < setpoints.size(); ++i) {
    setpoints[i] = Limit(model.joints[static_cast<std::size_t>(board.joints[i])], setpoints[i]);
  }
}

}  // namespace

void ControllerHost::Step(const FramePtr& frame, std::span<Setpoint> setpoints,
                          std::vector<SentMessage>& messages) {
  if (driven_.empty()) return;
  if (!supervision_.empty()) supervision_ = {};
  if (frame->scene != scene_) Rebind(frame->scene);
  if (!items_.empty()) {
    const Nanoseconds begun = clock_.Now();
    const std::string missing = readings_.Write(frame, wanted_, *set_);
    if (!missing.empty() && missing != missing_pictures_) {
      logger_->warn("camera pictures of controllers are black: {}", missing);
      missing_pictures_ = missing;
    }
    const Nanoseconds sensed = clock_.Now();
    StopCasualties(set_->Step(*frame, items_));
    times_.sense += sensed - begun;
    times_.control += clock_.Now() - sensed;
  }
  bool stopped = false;
  for (Driven& driven : driven_) {
    if (driven.status == Status::kUnloaded || driven.gone()) continue;
    const std::span<Setpoint> channels = setpoints.subspan(driven.first_channel, driven.channel_count);
    std::ranges::fill(channels, Setpoint{});
    if (driven.status != Status::kDrives) continue;
    // The child has checked the command, but a controller may overwrite it at any time.
    coopdyn_command command{};
    CopyCommand(set_->areas().result(driven.slot).command, command);
    const bool by_setpoints = (driven.readings & COOPDYN_SETPOINTS) != 0;
    const bool by_motors = (driven.readings & COOPDYN_MAPPED) != 0;
    if (!IsFine(command) || (by_setpoints && !TakeSetpoints(driven, channels)) ||
        (by_motors && !TakeMotors(*frame, driven, channels)) || !TakeLogs(driven, command) ||
        (driven.supervises() && !TakeDoings())) {
      std::ranges::fill(channels, Setpoint{});
      Stop(driven, "had its command overwritten by another controller");
      stopped = true;
      continue;
    }
    if (driven.supervises()) continue;
    if (command.end_run != 0)
      supervision_.end = "controller " + driven.controller + " of " + driven.name + " ends the run";
    if (!by_setpoints && !by_motors) {
      double factor = 1;
      const auto speeds = WheelsFor(driven.drive, command.forward_m_s, command.turn_rad_s, factor);
      std::ranges::copy(SetpointsFor(speeds), channels.subspan(driven.wheels).begin());
    }
    if (command.message_count == 0) continue;
    SentMessage sent;
    sent.robot = static_cast<std::uint32_t>(driven.robot);
    sent.step = frame->step + 1;
    sent.message.count = command.message_count;
    std::copy_n(command.message, command.message_count, sent.message.values.begin());
    messages.push_back(sent);
  }
  if (stopped) ListItems();
}

bool ControllerHost::TakeSetpoints(const Driven& driven, std::span<Setpoint> channels) const {
  const Areas& areas = set_->areas();
  const RobotSetup& setup = areas.setup(driven.slot);
  const coopdyn_joint* joints = areas.in.At<coopdyn_joint>(setup.joints);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const coopdyn_setpoint given = Once(areas.out.At<coopdyn_setpoint>(setup.setpoints)[i]);
    if (!IsFine(given, joints[i].modes)) return false;
    if (given.mode != COOPDYN_OFF) channels[i] = {given.reference, static_cast<ControlMode>(given.mode)};
  }
  std::size_t first = 0;
  const RobotModel& model = *scene_->robots[static_cast<std::size_t>(driven.robot)].entry.model;
  for (const ActuatorModel& actuator : model.actuators) {
    const std::span<Setpoint> its = channels.subspan(first, actuator.joints.size());
    if (const auto* drive = std::get_if<DriveModel>(&actuator.kind)) {
      LimitSpeeds(*drive, its);
    } else {
      LimitJoints(model, actuator, its);
    }
    first += actuator.joints.size();
  }
  return true;
}

bool ControllerHost::TakeMotors(const Frame& frame, Driven& driven, std::span<Setpoint> channels) const {
  const Areas& areas = set_->areas();
  const RobotSetup& setup = areas.setup(driven.slot);
  if (frame.step % setup.exchange_steps == 0) {
    std::vector<double> external(setup.robot.motor_count);
    const auto* motors = areas.out.At<double>(setup.motors);
    for (std::size_t i = 0; i < external.size(); ++i) external[i] = Once(motors[i]);
    if (!std::ranges::all_of(external, [](double value) { return std::isfinite(value); })) return false;
    driven.held = ChannelSetpoints(frame, driven.robot, 0, external);
    // Channels without a motor are at rest.
    std::ranges::replace_if(
        driven.held, [](const Setpoint& one) { return one.mode == ControlMode::kKeep; }, Setpoint{});
  }
  std::copy_n(driven.held.begin(), std::min(driven.held.size(), channels.size()), channels.begin());
  return true;
}

bool ControllerHost::TakeLogs(const Driven& driven, const coopdyn_command& command) {
  const Areas& areas = set_->areas();
  const auto* logs = areas.out.At<coopdyn_logged>(areas.setup(driven.slot).logs);
  for (std::uint32_t i = 0; i < command.log_count; ++i) {
    const coopdyn_logged logged = Once(logs[i]);
    if (!IsFine(logged)) return false;
    supervision_.logs.push_back({(driven.supervises() ? "" : driven.name + ".") + logged.name, logged.value});
  }
  return true;
}

bool ControllerHost::TakeDoings() {
  const Areas& areas = set_->areas();
  auto doing = Once(*areas.out.At<coopdyn_supervision>(areas.header().supervision));
  if (doing.move_count > COOPDYN_MAX_MOVES) return false;
  const auto* moves = areas.out.At<coopdyn_move>(areas.header().moves);
  for (std::size_t i = 0; i < doing.move_count; ++i) {
    const coopdyn_move move = Once(moves[i]);
    if (!IsFine(move)) return false;
    const double *p = move.pose.p_m, *q = move.pose.q;
    const Pose X_W{Vector3(p[0], p[1], p[2]), Quaternion(q[0], q[1], q[2], q[3]).normalized()};
    supervision_.moves.push_back({static_cast<std::int32_t>(move.id), X_W});
  }
  doing.why[COOPDYN_MAX_TEXT - 1] = '\0';
  if (doing.end_run != 0) supervision_.end = Printable(doing.why);
  return true;
}

}  // namespace coopdyn
