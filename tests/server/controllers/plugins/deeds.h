// SPDX-License-Identifier: MIT
// What the controller `hostile` does, by its option `deed`.
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

}  // namespace coopdyn
