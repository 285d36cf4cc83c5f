// SPDX-License-Identifier: MIT
// What a RunReader holds; for run_reader*.cc alone. One thread.
#pragma once

#include <sys/types.h>

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/record/run_reader.h"
#include "server/record/run_reader_open.h"

namespace coopdyn {

struct RunReader::Impl {
  /// Prepared once for each opening; they go before their database.
  struct Statements {
    Statement first, last;            // step, time_ns
    Statement first_keyframe;         // step
    Statement at_or_after;            // step, time_ns of the first at or after ?1
    Statement shown_before;           // step of the newest before ?1 with poses
    Statement shown_after;            // the first after ?1
    Statement whole, inputs;          // one step
    Statement keyframe, scene, meta;  // meta: value of ?1
  };

  std::string file;
  ino_t inode = 0;  // of the file when it was opened first
  OpenedRun run;
  std::optional<Statements> sql;
  RunHeader header;
  RunExtent extent;
  std::string error;
  int unchanged = 0;  // looks at a growing file that found nothing new
  std::unique_ptr<RobotLibrary> library;
  std::shared_ptr<const Scenario> scenario;
  std::unordered_map<std::uint64_t, std::shared_ptr<const Scene>> scenes;
  std::vector<RunInput> run_inputs;  // as far as they were read
  std::int64_t newest_input = 0;

  Database& database() { return *run.database; }
  /// Opens the file, or opens it again. False with error.
  bool Open();
  bool Prepare();
  /// Looks up the extent and whether it grows still. False with error.
  bool Refresh();
  bool Look();
  /// True, and error says so, if another file has the name by now: SQLite would mix the two up.
  bool FailAsReplaced();
  /// False, and error says that SQLite could not read `what`, e.g. "step 17".
  bool FailReading(const DatabaseError& failed, const std::string& what);
  /// What `read()` gives; nothing, and error says so, if SQLite cannot read `what` or has no statements.
  template <typename Read>
  auto Guard(const std::string& what, Read read) -> decltype(read()) {
    try {
      if (!sql) throw DatabaseError(file, false);
      return read();
    } catch (const DatabaseError& failed) {
      FailReading(failed, what);
      return {};
    }
  }
  /// False, and error says that `what`, e.g. "the poses of step 17", do not add up.
  bool FailSense(const std::string& what);
  /// The integer in column 0 of the one row of `statement` for parameter `key`; nothing if there is no row.
  std::optional<std::uint64_t> One(Statement& statement, std::uint64_t key);
  /// The row that `statement` stands at, checked against its scene.
  bool Decode(const Statement& row, bool inputs_only, RecordedStep& step);
  bool DecodeReadings(const Statement& row, const Scene& scene, RecordedStep& step);
  // As those of RunReader, under its Guard().
  std::shared_ptr<const Scene> SceneOf(std::uint64_t scene);
  std::optional<std::uint64_t> StepAt(Nanoseconds time, bool with_poses);
  std::optional<std::uint64_t> NextShown(std::uint64_t step, bool back);
  std::int64_t Meta(const char* key);  // a number of `meta`; 0: it is not there
  std::optional<RecordedStep> Read(std::uint64_t step, bool inputs_only);
  bool ForEach(std::uint64_t first, std::uint64_t last, bool inputs_only,
               const std::function<bool(const RecordedStep&)>& use);
  SavedStatePtr Keyframe(std::uint64_t step);
  RunContents Contents();
};

}  // namespace coopdyn
