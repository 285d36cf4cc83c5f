// SPDX-License-Identifier: MIT
// A robot's hardware module without its socket: requests in, readings and set-points out. Devices have no
// mutable state: all readings come from the frame. Any thread.
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

/// The effect of an actuator command.
struct Actuation {
  std::vector<Setpoint> setpoints;  // for the module's channels, within their limits
  std::optional<int> steps = {};    // as requested; empty: one
  std::string limited = {};         // `limited to …` if the command exceeded the limits, else empty
  std::string refusal = {};         // the error in the command's data; empty: none
};

/// StepNote() when a trial must end.
inline constexpr const char* kAborted = "aborted";

class Device {
 public:
  /// `table` outlives it.
  explicit Device(const CommandTable& table) : table_(table) {}
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// The device's commands, including those that every module has.
  const CommandTable& table() const { return table_; }
  /// The default get-command of `subscribe` and `attach`.
  command::Id first_reading() const { return table_.first_reading(); }
  /// True if the module drives the robot and so can be owned.
  virtual bool is_actuator() const { return false; }
  /// True if it drives all actuators of the robot: Actuate() has set-points for all channels.
  virtual bool drives_all() const { return false; }
  /// Text for the reply to an actuator command after its step, unless it was limited.
  virtual std::string StepNote(const Frame& /*frame*/, int /*robot*/) const { return {}; }
  /// Answers a get-command for robot `robot` (index into the scene's robots) from `frame`, without the final
  /// time_s and step. @pre CheckRequest() has accepted the request.
  virtual Message Read(const Message& request, const Frame& frame, int robot) const = 0;
  /// The frame that the readings of robot `robot` show: `frame` or an earlier sample.
  virtual const Frame& Shown(const Frame& frame, int /*robot*/) const { return frame; }
  /// Appends the data of the first reading.
  virtual void AppendFirstReading(const Frame& frame, int robot, std::vector<double>& data) const = 0;
  /// The effect of an actuator command for robot `robot` in its state in `frame`; nullopt if `request` is no
  /// such command. @pre as for Read().
  virtual std::optional<Actuation> Actuate(const Message& /*request*/, const Frame& /*frame*/,
                                           int /*robot*/) const {
    return std::nullopt;
  }
  /// The tuning that a request asks for, without the robot's name; nullopt if it is another request. @pre as
  /// for Read().
  virtual std::optional<edit::TuneJoints> Tune(const Message& /*request*/) const { return std::nullopt; }
  /// The camera picture that a request asks for; nullopt if it is another request. @pre as for Read().
  virtual std::optional<ImageRequest> Picture(const Message& /*request*/, const FramePtr& /*frame*/,
                                              int /*robot*/) const {
    return std::nullopt;
  }
  /// The error reply to a request that its spec allows but the device does not; nullopt if it is valid.
  virtual std::optional<Message> Refuse(const Message& /*request*/) const { return std::nullopt; }
  /// The robot's broadcast; nullopt if `request` does not ask for one. @pre as for Read().
  virtual std::optional<RobotMessage> Broadcast(const Message& /*request*/) const { return std::nullopt; }

 private:
  const CommandTable& table_;
};

/// The reply to a request for a picture.
Message ImageReply(command::Id command, const ImageResult& result);

/// The device of module `name` of robots of type `model`; null if there is none.
std::unique_ptr<Device> MakeDevice(const RobotModel& model, std::string_view name);

}  // namespace coopdyn
