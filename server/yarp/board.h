// SPDX-License-Identifier: MIT
// A group of joints as a control board of YARP, whatever words it is asked in: what it has, what it is told,
// which commands of the module that becomes. Pure; any thread.
//
// YARP's units are degrees, degrees/s, N m and N m/degree for joints that turn; m, m/s, N and N/m for those
// that slide. Its joints are counted from 0.
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

/// The modes of our joints, as get_board counts them.
enum class BoardMode { kIdle, kPosition, kDirect, kVelocity, kTorque, kPwm };
/// YARP's word for it: "pos". Nothing: a mode that we do not have.
std::string_view BoardModeWord(BoardMode mode);
/// Also by the words that mean nearly the same: "veld" is velocity, "fidl" is idle.
std::optional<BoardMode> BoardModeNamed(std::string_view word);

/// In YARP's units.
struct BoardJoint {
  std::string name;
  bool slides = false;
  BoardMode mode = BoardMode::kPosition;
  bool arrived = true;
  double position = 0, velocity = 0, effort = 0;
  double target = 0, reference = 0;  // the way's end; in force, by the mode
  double lower = 0, upper = 0, max_velocity = 0, max_effort = 0;
  bool stiff = true;
  double stiffness = 0, damping = 0, offset = 0;  // stiffness of a stiff joint: what compliance begins with
  double speed = 0, acceleration = 0;             // of ways to targets
  double p = 0, i = 0, d = 0;
  double counts = 0;  // of the encoder in a revolution; 0: it is exact, or the joint slides
};

struct BoardState {
  double time_s = 0;
  std::int64_t step = 0;
  std::vector<BoardJoint> joints;
};
/// Of a reply to get_board, or a push of it. Nothing: it is neither.
std::optional<BoardState> ReadBoard(const Message& reply);

/// What a board can be asked for or told: one value a joint unless said otherwise.
enum class BoardItem {
  kNothing,  // that we do not have; `why` in BoardAnswer tells so
  kAxes,     // one value in all
  kName,     // in BoardAnswer::names
  kType,     // 0 turns, 1 slides
  kPosition,
  kVelocity,
  kEffort,
  kTarget,    // told: moves there
  kRelative,  // told only: moves by so much
  kDirect,
  kVelocityReference,
  kTorque,
  kSpeed,
  kAcceleration,
  kDone,            // one value in all
  kStop,            // told only, no value
  kPositionLimits,  // two values, as all limits and ranges
  kVelocityLimits,
  kTorqueRange,
  kMode,       // BoardMode
  kCompliant,  // 0 or 1
  kImpedance,  // stiffness, damping
  kImpedanceOffset,
  kImpedanceLimits,  // two of the stiffness, two of the damping
  kPid,              // p, d, i, and seven that are 0
  kPidReset,         // told only, no value
  kPidReference,
  kPidError,
  kPidOutput,
  kPidEnabled,
  kAmplifier,  // 1: the motor is on
  kGearRatio,
  kCounts,  // asked only
};
/// How many values each joint has; 0: none, or it is of the board.
std::size_t BoardWidth(BoardItem item);

struct BoardCall {
  BoardItem item = BoardItem::kNothing;
  bool tells = false;                           // else it asks
  std::optional<std::vector<int>> joints = {};  // nothing: all
  std::vector<double> values = {};              // joint by joint
  std::string refusal = {};                     // of kNothing
};

struct BoardAnswer {
  enum class Kind { kDone, kFailed, kNotThere, kOutOfBounds };
  Kind kind = Kind::kDone;
  std::string why = {};
  std::vector<double> values = {};      // joint by joint
  std::vector<std::string> names = {};  // of kName
  std::vector<Message> commands = {};   // for the module, before the answer is true
};

/// What one client has told a board and need not be in force yet. Its own thread.
class BoardClient {
 public:
  /// Answers `call` by `state`, as it will be when what was told before is in force.
  BoardAnswer Answer(const BoardCall& call, BoardState state);
  /// The module has taken a command of the last answer.
  void Taken(const Message& command, const Message& reply);

 private:
  struct Joint {
    std::int64_t until_step = -1;  // then the board's own state tells
    std::optional<BoardMode> mode;
    bool moves = false;
    std::optional<double> reference = {};  // in the module's units
  };
  static void OverlayReference(double reference, BoardJoint& joint);
  void Overlay(BoardState& state) const;
  BoardAnswer Tell(const BoardCall& call, const BoardState& state, const std::vector<std::size_t>& joints);
  Message Compliance(const BoardCall& call, const BoardState& state, const std::vector<std::size_t>& joints);

  std::vector<Joint> told_;
  std::vector<std::optional<std::pair<double, double>>>
      impedances_;  // of stiff joints: for when they are not
};

}  // namespace coopdyn
