// SPDX-License-Identifier: MIT
// The files of a recording: lesson1.run, and after resets and loads lesson1-2.run and so on. A name that is
// taken is left alone, but for the one that the user has given.
#pragma once

#include <memory>
#include <string>

#include "server/record/recorder.h"
#include "server/record/run_writer.h"

namespace coopdyn {

/// Make() and NoteMade() by one thread, the rest by any.
class RecordingFiles {
 public:
  /// `options` outlive it.
  explicit RecordingFiles(const RecorderOptions& options) : options_(options) {}

  /// lesson1-2.run for 2; the given one for 1.
  std::string Name(int number) const;
  bool IsTaken(int number) const;
  /// Why the first one cannot be made; empty if it can.
  std::string WhyNone() const;
  /// Whether the disk has the room that a recording needs.
  bool HasRoom() const;
  /// The file with this number, or, if somebody has taken its name meanwhile, the next free one. Null, and
  /// `error` says why, if it cannot be made.
  std::unique_ptr<RunWriter> Make(const SavedState& state, int number, std::string& error);
  /// The first one holds something: only new names from now on.
  void NoteMade() { has_made_ = true; }

 private:
  const RecorderOptions& options_;
  const std::string build_ = BuildId();  // before the run, as it reads the whole program
  bool has_made_ = false;
};

}  // namespace coopdyn
