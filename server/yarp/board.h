// SPDX-License-Identifier: MIT
// A group of joints as a YARP control board, independent of the request's language: its state, calls, and the
// module's commands that they become. Pure; any thread.
//
// YARP's units are degrees, degrees/s, N m and N m/degree for rotating joints; m, m/s, N and N/m for sliding
// ones. Its joints are counted from 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/message.h"

namespace coopdyn {

/// The modes of joints, numbered as in get_board.
enum class BoardMode { kIdle, kPosition, kDirect, kVelocity, kTorque, kPwm };
/// YARP's word for the mode: "pos".
std::string_view BoardModeWord(BoardMode mode);
/// The reverse, also for near synonyms: "veld" is velocity, "fidl" is idle. Nullopt if there is no such mode.
std::optional<BoardMode> BoardModeNamed(std::string_view word);

/// In YARP's units.
struct BoardJoint {
  std::string name;
  bool slides = false;
  BoardMode mode = BoardMode::kPosition;
  bool arrived = true;
  double position = 0, velocity = 0, effort = 0;
  double target = 0, reference = 0;  // end of the trajectory; in force, according to the mode
  double lower = 0, upper = 0, max_velocity = 0, max_effort = 0;
  bool stiff = true;
  double stiffness = 0, damping = 0, offset = 0;  // stiffness of a stiff joint: used when it becomes
                                                  // compliant
  double speed = 0, acceleration = 0;             // of trajectories to targets
  double p = 0, i = 0, d = 0;
  double counts = 0;  // encoder counts per revolution; 0: exact encoder or sliding joint
};

struct BoardState {
  double time_s = 0;
  std::int64_t step = 0;
  std::vector<BoardJoint> joints;
};
/// Parses a reply to get_board, or a push of it. Nullopt for any other message.
std::optional<BoardState> ReadBoard(const Message& reply);

/// An item of a board that can be read or set: one value per joint unless stated otherwise.
enum class BoardItem {
  kNothing,  // not supported; BoardAnswer::why says so
  kAxes,     // one value for the board
  kName,     // in BoardAnswer::names
  kType,     // 0: rotates, 1: slides
  kPosition,
  kVelocity,
  kEffort,
  kTarget,    // set: moves there
  kRelative,  // set only: moves by this distance
  kDirect,
  kVelocityReference,
  kTorque,
  kSpeed,
  kAcceleration,
  kDone,            // one value for the board
  kStop,            // set only, no value
  kPositionLimits,  // two values, like all limits and ranges
  kVelocityLimits,
  kTorqueRange,
  kMode,       // BoardMode
  kCompliant,  // 0 or 1
  kImpedance,  // stiffness, damping
  kImpedanceOffset,
  kImpedanceLimits,  // two for the stiffness, two for the damping
  kPid,              // p, d, i, and seven zeros
  kPidReset,         // set only, no value
  kPidReference,
  kPidError,
  kPidOutput,
  kPidEnabled,
  kAmplifier,  // 1: the motor is on
  kGearRatio,
  kCounts,  // read only
};
/// Number of values per joint; 0: none, or the item belongs to the board.
std::size_t BoardWidth(BoardItem item);

struct BoardCall {
  BoardItem item = BoardItem::kNothing;
  bool tells = false;                           // sets the item; else reads it
  std::optional<std::vector<int>> joints = {};  // nullopt: all
  std::vector<double> values = {};              // joint by joint
  std::string refusal = {};                     // for kNothing
};

struct BoardAnswer {
  enum class Kind { kDone, kFailed, kNotThere, kOutOfBounds };
  Kind kind = Kind::kDone;
  std::string why = {};
  std::vector<double> values = {};      // joint by joint
  std::vector<std::string> names = {};  // for kName
  std::vector<Message> commands = {};   // commands to the module before the answer is valid
};

/// A client's commands to a board that may not be in force yet. One thread.
class BoardClient {
 public:
  /// Answers `call` from `state`, as if the client's earlier commands were in force.
  BoardAnswer Answer(const BoardCall& call, BoardState state);
  /// The module has executed a command of the last answer.
  void Taken(const Message& command, const Message& reply);

 private:
  struct Joint {
    std::int64_t until_step = -1;  // then the board's own state is current
    std::optional<BoardMode> mode;
    bool moves = false;
    std::optional<double> reference = {};  // in the module's units
  };
  static void OverlayReference(double reference, BoardJoint& joint);
  void Overlay(BoardState& state) const;
  BoardAnswer Tell(const BoardCall& call, const BoardState& state, const std::vector<std::size_t>& joints);
  Message Compliance(const BoardCall& call, const BoardState& state, const std::vector<std::size_t>& joints);

  std::vector<Joint> commanded_;
  std::vector<std::optional<std::pair<double, double>>>
      impedances_;  // of stiff joints, for when they become compliant
};

}  // namespace coopdyn
