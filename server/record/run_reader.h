// SPDX-License-Identifier: MIT
// Reads a recording, also one that another process is still writing or that a crash left behind. Nothing in a
// file is trusted: inconsistent content becomes an error text, never a crash. One thread; nothing throws.
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

/// A summary of a file besides its steps, for `coopdyn info`.
struct RunContents {
  struct Robot {
    std::string name, type;
  };
  std::vector<Robot> robots;    // of the first scene
  std::uint64_t bodies = 0;     // of the first scene
  std::uint64_t scenes = 0;     // more than one if things or robots were added or removed
  std::uint64_t bytes = 0;      // of the file, and of its log while it is being written
  std::uint64_t keyframes = 0;  // exact states
  std::uint64_t last_hash = 0;  // of the exact state after the last step
  std::uint64_t inputs = 0;     // edits, deadlines, …: all but commands
};

/// The range of steps in a file.
struct RunExtent {
  std::uint64_t first = 0, last = 0;  // step numbers; the first is a keyframe
  Nanoseconds begin = 0, end = 0;     // their simulated times
  std::uint64_t steps = 0;            // recorded after the first frame
  std::uint64_t lost = 0;             // left out between first and last
  std::uint64_t lost_after = 0;       // left out after the last step, until the recording ended
  std::uint64_t missing = 0;          // after the last step: were in the file when it was closed
};

class RunReader {
 public:
  /// Null with `error` ("lesson1.run: …", what is wrong and what to do) if `file` is not a readable
  /// recording. First mends a file left by a crash, if the file is writable and has no writer.
  static std::unique_ptr<RunReader> Open(const std::string& file, std::string& error);
  RunReader(const RunReader&) = delete;
  RunReader& operator=(const RunReader&) = delete;

  const std::string& file() const { return file_; }
  const RunHeader& header() const { return header_; }
  /// The file was mended: the recording had not been closed completely.
  bool mended() const { return run_.mended; }
  /// The file was being written at the last extent() or Open(). extent() notices at once that the recording
  /// was closed, and after ten calls without new steps that its writer has died.
  bool growing() const { return run_.growing; }
  /// A non-empty log lies beside the file (see UnmergedLog()): the file alone is not the whole run.
  bool has_log() const { return !UnmergedLog(file_).empty(); }
  /// The file has a column for the scores of each step; older files do not.
  bool has_scores() const { return has_scores_; }
  /// Why the log was not merged into the file, e.g. "another program reads it". Empty if it was, or without a
  /// log.
  const std::string& log_reason() const { return run_.log_reason; }
  /// Nullopt, with error() set, if the file is damaged. Needs no scenario.
  std::optional<RunContents> Contents();
  /// The total number of set-points that came into force; reads every step. Nullopt if the file is damaged.
  std::optional<std::uint64_t> CountCommands();
  /// While the file grows, each call looks the extent up again.
  RunExtent extent();

  /// Reads the embedded scenario with the embedded worlds and robot models; finds loaded controllers on
  /// `path`. Null with diagnostics on failure. Before SceneOf(), Read() …
  std::shared_ptr<const Scenario> LoadScenario(const SearchPath& path, Diagnostics& diagnostics);
  /// Use instead of LoadScenario() if the same scenario has been read already, e.g. by another reader of the
  /// same file.
  void UseScenario(std::shared_ptr<const Scenario> scenario);

  // All below return false, nullopt, empty or null, with error() set, if the file is damaged there.
  const std::string& error() const { return error_; }
  /// Scene number `scene` of the file. Null if unknown.
  std::shared_ptr<const Scene> SceneOf(std::uint64_t scene);
  /// The newest recorded step at or before `time` (else the first). `with_poses`: considers only steps with
  /// poses.
  std::optional<std::uint64_t> StepAt(Nanoseconds time, bool with_poses);
  /// The first step with poses after `step` (before it if `back`). Nullopt at the end, or, with error() set,
  /// if a step in between is missing that was not lost.
  std::optional<std::uint64_t> NextShown(std::uint64_t step, bool back);
  /// Step `step`; nullopt if it is not recorded. `inputs_only`: without poses and readings, which is faster.
  std::optional<RecordedStep> Read(std::uint64_t step, bool inputs_only = false);
  /// Calls `use` for the steps first…last in order; stops when it returns false. False if the file is
  /// damaged.
  bool ForEach(std::uint64_t first, std::uint64_t last, bool inputs_only,
               const std::function<bool(const RecordedStep&)>& use);
  /// Step numbers of all keyframes, increasing.
  std::vector<std::uint64_t> Keyframes();
  /// The newest keyframe at or before `step`, exact.
  SavedStatePtr Keyframe(std::uint64_t step);
  /// Inputs that arrived after frames first…last, in order.
  std::vector<RunInput> Inputs(std::uint64_t first, std::uint64_t last);
  std::vector<Event> Events();
  /// Events in rows after `id`; sets `id` to the last row. Start with 0.
  std::vector<Event> EventsAfter(std::int64_t& id);

 private:
  /// Carries the text of error().
  struct Failure {
    std::string text;
  };

  explicit RunReader(std::string file) : file_(std::move(file)) {}

  /// Returns `get()`. If it throws, returns an empty value and sets error(): `what`, e.g. "step 17", cannot
  /// be read.
  template <typename Get>
  auto Guard(const std::string& what, Get get) -> decltype(get());

  // All below throw Failure and DatabaseError.
  const Database& database() const;
  [[noreturn]] void Damaged(const std::string& what) const;
  /// Another file has taken the name: SQLite would mix up the two.
  bool IsReplaced() const;
  void CheckNotReplaced() const;
  /// Opens the file, or opens it again.
  void Reopen();
  /// Updates the extent and whether the file still grows.
  void Refresh();
  RunExtent Look() const;
  /// The step number that `sql` returns for parameter `step`; nullopt without a row.
  std::optional<std::uint64_t> FindStep(const char* sql, std::uint64_t step) const;
  std::int64_t Meta(const char* key) const;  // a number of `meta`; 0 if missing
  /// Decodes the current row of `row`, checked against its scene.
  RecordedStep Decode(const Statement& row, bool inputs_only);
  std::shared_ptr<const Scene> FindScene(std::uint64_t scene);
  FindModel ModelFinder();
  FindTexture TextureFinder();
  /// Reads the texts of things that were inserted since the file was opened.
  void ReadTextsAgain();

  const std::string file_;
  ino_t inode_ = 0;  // of the file when first opened
  OpenedRun run_;
  RunHeader header_;
  RunExtent extent_;
  std::string error_;
  bool has_scores_ = false;
  int unchanged_ = 0;  // consecutive looks at a growing file without new steps
  std::unique_ptr<RobotLibrary> library_;
  std::shared_ptr<const Scenario> scenario_;
  std::unordered_map<std::uint64_t, std::shared_ptr<const Scene>> scenes_;
  std::unordered_map<std::string, std::shared_ptr<const Image>> images_;  // of textures, by their key
  std::vector<RunInput> inputs_;                                          // read so far
  std::int64_t newest_input_ = 0;
};

}  // namespace coopdyn
