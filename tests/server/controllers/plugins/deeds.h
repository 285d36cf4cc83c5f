// SPDX-License-Identifier: MIT
// Deeds of the controllers `hostile` and `setpoints`, chosen by their option `deed`.
#pragma once

namespace coopdyn {

enum Deed {
  kNone,
  // In step():
  kThrowError,
  kThrowInt,
  kDivideByZero,
  kNotANumber,
  kInfinity,
  kNotANumberInMessage,
  kTooLongMessage,
  kSleep,
  kSpin,
  kWriteNowhere,
  kWritePastCommand,
  kWriteReadings,
  kAbort,
  kExit,
  kExitAtOnce,
  kOverflowStack,
  kKillItself,
  kKillOnce,     // if it can remove the file HOSTILE_MARKER
  kFork,         // harmless
  kShrinkAreas,  // memory shared with the daemon
  kGrowAreas,
  kWriteInputs,
  kOverwriteOutputs,        // repeatedly
  kOverwriteOutputsBeside,  // from a thread that it starts
  kLeakWithNew,
  kLeakWithMalloc,
  // In save():
  kSavePastState,
  kThrowInSave,
  // Else:
  kCrashInCreate,
  kThrowInCreate,
  kRefuse,
  kRefuseSilently,
  kHangInCreate,
  kCrashInReset,
  kCrashInRestore,
  kThrowInRestore,
  kHangInDestroy,
};

/// Of the controller `setpoints`.
enum SetpointDeed {
  kSwing,      // all channels, from their readings
  kByForward,  // forward 0.05 m/s, turn 0.3 rad/s
  kTooFast,
  kOnlyOne,  // the first channel is off
  kNoSuchMode,
  kModeNotTaken,
  kReferenceNotANumber,
  kOtherPointer,
  kWritePastSetpoints,
};

/// Of the supervisor `overseer`.
enum OverseerDeed {
  kWatches,   // logs its observations
  kMovesAll,  // things, robots, targets and lights, 1 m along x
  kEndsRun,
  kMovesNobody,  // an unknown id
  kMovesTwice,
  kMovesInto,  // the first robot into the second
  kMovesTooMany,
  kMovesToNowhere,
  kTurnsWrongly,
  kLogsTooMuch,
  kLogsNotANumber,
  kLogsUnderABadName,
  kLogsUnderALongName,
  kOtherSupervision,
  kOtherMoves,
  kOtherLogs,
  kWritesPastMoves,
  kWritesPastLogs,
  kWritesWorld,
  kOverseerThrows,
  kOverseerCrashes,
  kOverseerHangs,
};

}  // namespace coopdyn
