// SPDX-License-Identifier: MIT
// What the controllers `hostile` and `setpoints` do, by their option `deed`.
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
  kShrinkAreas,  // what it shares with the daemon
  kGrowAreas,
  kWriteInputs,
  kOverwriteOutputs,        // over and over
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
  kSwing,      // all channels, from what they read
  kByForward,  // forward 0.05 m/s, turn 0.3 rad/s
  kTooFast,
  kOnlyOne,  // the first is off
  kNoSuchMode,
  kModeNotTaken,
  kReferenceNotANumber,
  kOtherPointer,
  kWritePastSetpoints,
};

/// Of the supervisor `overseer`.
enum OverseerDeed {
  kWatches,   // logs what it sees
  kMovesAll,  // things, robots, targets and lights, 1 m along x
  kEndsRun,
  kMovesNobody,  // an id that is not there
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
