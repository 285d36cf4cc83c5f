// SPDX-License-Identifier: MIT
// Writes one run file, step by step (docs/formats.md). What is committed survives a crash. One thread;
// nothing throws.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/record/row_chain.h"
#include "server/record/run_header.h"
#include "server/record/sqlite_db.h"
#include "server/state/image_board.h"
#include "server/state/run_journal.h"

namespace coopdyn {

struct RunWriterOptions {
  RunHeader header;
  bool overwrite = false;      // a recording, or an empty file
  bool durable = false;        // a commit survives a power cut too
  std::size_t page_size = 0;   // of SQLite; 0: what suits the rows
  std::int64_t max_pages = 0;  // beyond that the disk counts as full; 0: no such limit. For tests
  DrawImage draw;              // of cameras, if RecordWhat::images is on; null: there are none
};

class RunWriter {
 public:
  /// Makes `file` with the scenario and scene of `first`, its frame as first row and keyframe, all committed.
  /// Null with `error` ("lesson1.run exists: choose another name, or --force") if that fails; no file is left
  /// then.
  static std::unique_ptr<RunWriter> Create(const std::string& file, RunWriterOptions options,
                                           const SavedState& first, std::string& error);
  /// Closes the file as it is, without what was not committed. See Close().
  ~RunWriter();
  RunWriter(const RunWriter&) = delete;
  RunWriter& operator=(const RunWriter&) = delete;

  // False: it could not be written, and error() says why. What was not committed is gone, and the file takes
  // no more until GoOn().
  /// A step of the run; steps grow. A scene other than the last frame's is written too.
  bool AddStep(const Frame& frame);
  /// The pictures that cameras have taken in a step that was added; nothing unless RecordWhat::images is on.
  bool AddImages(const FramePtr& frame);
  /// The exact state of a step that was added.
  bool AddKeyframe(const SavedState& state);
  bool AddInput(const RunInput& input);
  bool AddEvent(const Event& event);
  /// Notes that `steps` more steps were left out.
  bool AddLost(std::uint64_t steps);
  /// The same for steps after the last one in the file.
  bool AddLostAfter(std::uint64_t steps);
  /// Makes what was added so far safe from a crash, and visible to readers.
  bool Commit();
  /// Forgets the failure: what comes now stands after what was committed. The next step is to be a keyframe.
  void GoOn();
  /// Commits and makes it one plain file. If another process has it open, a -wal file stays beside it, and
  /// `remark` says so.
  bool Close(std::string& remark);

  const std::string& file() const { return file_; }
  /// "lesson1.run: the disk is full".
  const std::string& error() const { return error_; }
  /// It failed for want of room: there may be some later.
  bool full() const { return full_; }
  /// Steps after the first frame, also those not yet committed.
  std::uint64_t steps() const { return now_.steps; }
  /// Steps left out, as AddLost() said; also those not yet committed.
  std::uint64_t lost() const { return now_.lost; }
  Nanoseconds begin() const { return begin_; }
  Nanoseconds end() const { return now_.end; }
  /// Something was added since the last Commit().
  bool dirty() const { return dirty_; }
  /// Of the file and what lies beside it until it is closed. Asks the file system.
  std::uint64_t bytes() const;

 private:
  RunWriter(std::string file, RunWriterOptions options);

  bool Open(const SavedState& first);
  /// `write()` in a transaction. False if it throws: error() says why, and the transaction is undone.
  template <typename Write>
  bool Try(Write write);
  /// Writes the texts of models and textures that the file does not have yet.
  void WriteTexts(const Scene& scene);
  void BeginScene(const Frame& frame);
  void WriteRow(const Frame& frame);
  void WriteImage(CameraShot shot);
  void WriteEvent(const Event& event);
  void EncodeShown(const Frame& frame);
  /// Set-points that differ from those in force so far, or all of a new scene; into commands_.
  void FindCommands(const Frame& frame, bool new_scene);
  bool IsShown(Nanoseconds time) const;

  const std::string file_;
  const RunWriterOptions options_;
  std::unique_ptr<Database> database_;
  struct Statements {
    Statement step, image, keyframe, input, event;
  };
  Statements insert_;  // they go before the database
  std::string error_;
  bool dirty_ = false, full_ = false;
  bool drew_none_ = false;  // that was said
  Nanoseconds begin_ = 0;

  /// What the rows so far mean for those to come.
  struct Progress {
    TableEnds ends;
    std::shared_ptr<const Scene> scene;
    std::int64_t scene_number = 0;
    std::vector<SourceText> texts;    // of things that came later: kinds and names
    std::vector<Setpoint> in_force;   // of scene->channels
    std::vector<bool> is_recomputed;  // of scene->robots: its controller's set-points are left out
    std::uint64_t steps = 0, lost = 0, lost_after = 0, last_step = 0;
    Nanoseconds end = 0;
    Nanoseconds shown = -1;                                     // time of the last step with poses
    std::map<std::pair<int, std::size_t>, Nanoseconds> images;  // by robot and sensor: time of the last one
  };
  Progress now_, committed_;

  // Of the step in the making; kept for their memory.
  std::vector<CommandRecord> commands_;
  std::vector<SentMessage> messages_;
  std::vector<std::byte> commands_blob_, messages_blob_, channels_, distances_, targets_, poses_, scores_;
};

/// Why a recording may not take the place of `file`, even with `overwrite` if that is no recording; empty if
/// it may, or nothing is there.
std::string WhyNoRunFile(const std::string& file, bool overwrite);

/// Removes `file` and what SQLite keeps beside it.
void RemoveRunFile(const std::string& file);

/// Of a recording that begins with `frame`; the rest (version, command, started) is the caller's.
RunHeader HeaderOf(const Frame& frame, Mode mode, const RecordWhat& what, Nanoseconds pose_every);

}  // namespace coopdyn
