// SPDX-License-Identifier: MIT
// A hardware module of a robot without its socket: requests in, readings and set-points out. Devices hold
// nothing that changes: what they read is in the frame. Any thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/command_ids.h"
#include "protocol/command_table.h"
#include "protocol/message.h"
#include "server/model/robot_model.h"
#include "server/state/command_board.h"
#include "server/state/edits.h"
#include "server/state/frame.h"
#include "server/state/image_board.h"

namespace coopdyn {

/// What an actuator command means.
struct Actuation {
  std::vector<Setpoint> setpoints;  // of the module's channels, within their limits
  std::optional<int> steps = {};    // as asked for; empty: one
  std::string limited = {};         // `limited to …` if the command was beyond the limits, else empty
  std::string refusal = {};         // what is wrong with its data; empty: nothing
};

/// The text of StepNote() when a try is to end.
inline constexpr const char* kAborted = "aborted";

class Device {
 public:
  /// `table` outlives it.
  explicit Device(const CommandTable& table) : table_(table) {}
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// The commands, with those that every module has.
  const CommandTable& table() const { return table_; }
  /// The get-command that `subscribe` and `attach` take.
  command::Id first_reading() const { return table_.first_reading(); }
  /// True if the module drives the robot, and so can be owned.
  virtual bool is_actuator() const { return false; }
  /// It drives all actuators of the robot; Actuate() has set-points for the channels of all.
  virtual bool drives_all() const { return false; }
  /// The text of the reply to an actuator command after its step, if there is more to say than what was
  /// limited.
  virtual std::string StepNote(const Frame& /*frame*/, int /*robot*/) const { return {}; }
  /// Answers a get-command for robot `robot` (index into the scene) from `frame`; without the final time_s
  /// and step.
  /// @pre CheckRequest() has accepted the request.
  virtual Message Read(const Message& request, const Frame& frame, int robot) const = 0;
  /// The moment that the readings of robot `robot` show: `frame`, or a sample before.
  virtual const Frame& Shown(const Frame& frame, int /*robot*/) const { return frame; }
  /// Appends the data of the first reading.
  virtual void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const = 0;
  /// The meaning of an actuator command for robot `robot`, which is as in `frame`; nothing if `request` is
  /// none. @pre as for Read().
  virtual std::optional<Actuation> Actuate(const Message& /*request*/, const Frame& /*frame*/,
                                           int /*robot*/) const {
    return std::nullopt;
  }
  /// How a request tunes the module, its robot's name left open; nothing if it does not. @pre as for Read().
  virtual std::optional<edit::TuneJoints> Tune(const Message& /*request*/) const { return std::nullopt; }
  /// The picture that a request asks of a camera; nothing if it is another request. @pre as for Read().
  virtual std::optional<ImageRequest> Picture(const Message& /*request*/, const FramePtr& /*frame*/,
                                              int /*robot*/) const {
    return std::nullopt;
  }
  /// The error reply to a request that its spec allows and the device does not; nothing if it is fine.
  virtual std::optional<Message> Refuse(const Message& /*request*/) const { return std::nullopt; }
  /// What the robot is to broadcast; nothing if `request` is no order to. @pre as for Read().
  virtual std::optional<RobotMessage> Broadcast(const Message& /*request*/) const { return std::nullopt; }

 private:
  const CommandTable& table_;
};

/// The reply to a request for a picture.
Message ImageReply(command::Id command, const ImageResult& result);

/// The device of the module `name` of robots of `model`; null if they have none.
std::unique_ptr<Device> MakeDevice(const RobotModel& model, std::string_view name);

}  // namespace coopdyn
