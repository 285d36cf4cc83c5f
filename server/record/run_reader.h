// SPDX-License-Identifier: MIT
// Reads a recording, also one that is still being written by another process, and one that a crash has left.
// Nothing in a file is trusted: what does not add up is an error text, never a crash. One thread; nothing
// throws.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/model/readers.h"
#include "server/record/recorded_step.h"
#include "server/record/run_header.h"
#include "server/record/run_open.h"
#include "server/state/run_journal.h"
#include "server/state/scene_code.h"

namespace coopdyn {

/// What a file holds besides steps, for `coopdyn info`.
struct RunContents {
  struct Robot {
    std::string name, type;
  };
  std::vector<Robot> robots;    // of the first scene
  std::uint64_t bodies = 0;     // of the first scene
  std::uint64_t scenes = 0;     // more than one: things came or went
  std::uint64_t bytes = 0;      // of the file, and of the log beside it while it is being written
  std::uint64_t keyframes = 0;  // each an exact state
  std::uint64_t last_hash = 0;  // of the exact state after the last step
  std::uint64_t inputs = 0;     // edits, deadlines, … all but commands
};

/// Which steps a file holds.
struct RunExtent {
  std::uint64_t first = 0, last = 0;  // step numbers; the first is a keyframe
  Nanoseconds begin = 0, end = 0;     // their simulated times
  std::uint64_t steps = 0;            // recorded after the first frame
  std::uint64_t lost = 0;             // left out between first and last
  std::uint64_t lost_after = 0;       // left out after the last, until the recording ended
  std::uint64_t missing = 0;          // after the last: they were there when the file was closed
};

class RunReader {
 public:
  /// Null with `error` ("lesson1.run: …", what is wrong and what to do) if it is no recording that can be
  /// read. A file left by a crash is mended first, if it may be written to and nobody writes it.
  static std::unique_ptr<RunReader> Open(const std::string& file, std::string& error);
  RunReader(const RunReader&) = delete;
  RunReader& operator=(const RunReader&) = delete;

  const std::string& file() const { return file_; }
  const RunHeader& header() const { return header_; }
  /// It was mended: the recording had not been closed, or not to the end.
  bool mended() const { return run_.mended; }
  /// It is being written at this moment, or was at the last extent(). extent() notices at once that the
  /// recording was closed, and after ten calls without news that its writer is gone.
  bool growing() const { return run_.growing; }
  /// A log with bytes lies beside it (UnmergedLog() names it), so that the file alone is not the whole run.
  bool has_log() const { return !UnmergedLog(file_).empty(); }
  /// It has a column for the scores of each step: older files have none.
  bool has_scores() const { return has_scores_; }
  /// "another program reads it": why it was not made part of the file. Empty if it was, or there is none.
  const std::string& log_reason() const { return run_.log_reason; }
  /// Nothing, and error() says why, if the file is damaged there. Needs no scenario.
  std::optional<RunContents> Contents();
  /// How many set-points came in force in all: looks at each step. Nothing if the file is damaged.
  std::optional<std::uint64_t> CountCommands();
  /// Looked up afresh with each call, so that a growing file can be followed.
  RunExtent extent();

  /// Reads the scenario that the file carries, with the file's own worlds and robot models; loaded
  /// controllers are found on `path`. Null with diagnostics. Before Scene(), Step() …
  std::shared_ptr<const Scenario> LoadScenario(const SearchPath& path, Diagnostics& diagnostics);
  /// Instead, if the same scenario has been read already, e.g. by another reader of the same file.
  void UseScenario(std::shared_ptr<const Scenario> scenario);

  // All below: false, nothing or null, and error() says why, if the file is damaged there.
  const std::string& error() const { return error_; }
  /// The scene number `scene` of the file. Null if unknown.
  std::shared_ptr<const Scene> SceneOf(std::uint64_t scene);
  /// The newest recorded step at or before `time` (the first if there is none). `with_poses`: that has poses.
  std::optional<std::uint64_t> StepAt(Nanoseconds time, bool with_poses);
  /// The first step after `step` (before, if `back`) that has poses; nothing at the end, or if a step on the
  /// way there is missing that was not lost.
  std::optional<std::uint64_t> NextShown(std::uint64_t step, bool back);
  /// Step `step`; nothing if it is not there. `inputs_only`: without poses and readings, which is fast.
  std::optional<RecordedStep> Read(std::uint64_t step, bool inputs_only = false);
  /// Steps first…last in order; stops when `use` returns false. False if the file is damaged.
  bool ForEach(std::uint64_t first, std::uint64_t last, bool inputs_only,
               const std::function<bool(const RecordedStep&)>& use);
  /// Step numbers of all keyframes, increasing.
  std::vector<std::uint64_t> Keyframes();
  /// The newest keyframe at or before `step`, exact.
  SavedStatePtr Keyframe(std::uint64_t step);
  /// Inputs that came after frames first…last, in order.
  std::vector<RunInput> Inputs(std::uint64_t first, std::uint64_t last);
  std::vector<Event> Events();
  /// Those of rows after `id`, which becomes that of the last one; it begins with 0.
  std::vector<Event> EventsAfter(std::int64_t& id);

 private:
  /// What error() is to say.
  struct Failure {
    std::string text;
  };

  explicit RunReader(std::string file) : file_(std::move(file)) {}

  /// What `get()` gives. Nothing, and error() says so, if it throws: that `what`, e.g. "step 17", cannot be
  /// read.
  template <typename Get>
  auto Guard(const std::string& what, Get get) -> decltype(get());

  // All below throw Failure and DatabaseError.
  const Database& database() const;
  [[noreturn]] void Damaged(const std::string& what) const;
  /// Another file has the name by now: SQLite would mix the two up.
  bool IsReplaced() const;
  void CheckNotReplaced() const;
  /// Opens the file, or opens it again.
  void Reopen();
  /// Looks up the extent and whether it grows still.
  void Refresh();
  RunExtent Look() const;
  /// The step number that `sql` gives for the parameter `step`; nothing if it gives no row.
  std::optional<std::uint64_t> FindStep(const char* sql, std::uint64_t step) const;
  std::int64_t Meta(const char* key) const;  // a number of `meta`; 0: it is not there
  /// The row that `row` stands at, checked against its scene.
  RecordedStep Decode(const Statement& row, bool inputs_only);
  std::shared_ptr<const Scene> FindScene(std::uint64_t scene);
  FindModel ModelFinder();
  FindTexture TextureFinder();
  /// The texts of things that were inserted since the file was opened.
  void ReadTextsAgain();

  const std::string file_;
  ino_t inode_ = 0;  // of the file when it was opened first
  OpenedRun run_;
  RunHeader header_;
  RunExtent extent_;
  std::string error_;
  bool has_scores_ = false;
  int unchanged_ = 0;  // looks at a growing file that found nothing new
  std::unique_ptr<RobotLibrary> library_;
  std::shared_ptr<const Scenario> scenario_;
  std::unordered_map<std::uint64_t, std::shared_ptr<const Scene>> scenes_;
  std::unordered_map<std::string, std::shared_ptr<const Image>> images_;  // of textures, by their key
  std::vector<RunInput> inputs_;                                          // as far as they were read
  std::int64_t newest_input_ = 0;
};

}  // namespace coopdyn
