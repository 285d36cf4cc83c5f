// SPDX-License-Identifier: MIT
// Writes one run file, step by step (docs/formats.md). Committed rows survive a crash. One thread; nothing
// throws.
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
  bool overwrite = false;      // replaces a recording or an empty file
  bool durable = false;        // a commit survives a power cut too
  std::size_t page_size = 0;   // of SQLite; 0: chosen to suit the rows
  std::int64_t max_pages = 0;  // beyond it the disk counts as full; 0: no limit. For tests
  DrawImage draw;              // draws camera images if RecordWhat::images is on; null: no images
};

class RunWriter {
 public:
  /// Makes `file` with the scenario and scene of `first` and its frame as the first row and keyframe, all
  /// committed. On failure returns null with `error` ("lesson1.run exists: choose another name, or --force")
  /// and leaves no file behind.
  static std::unique_ptr<RunWriter> Create(const std::string& file, RunWriterOptions options,
                                           const SavedState& first, std::string& error);
  /// Closes the file without uncommitted rows. See Close().
  ~RunWriter();
  RunWriter(const RunWriter&) = delete;
  RunWriter& operator=(const RunWriter&) = delete;

  // All below return false, with error() set, if the file could not be written. Then uncommitted rows are
  // lost, and the file accepts no more until Resume().
  /// Adds a step; step numbers increase. Also writes the scene if it differs from the last frame's.
  bool AddStep(const Frame& frame);
  /// Adds the pictures that cameras took in a step added before; does nothing unless RecordWhat::images is
  /// on.
  bool AddImages(const FramePtr& frame);
  /// Adds the exact state of a step added before.
  bool AddKeyframe(const SavedState& state);
  bool AddInput(const RunInput& input);
  bool AddEvent(const Event& event);
  /// Notes that `steps` more steps were left out.
  bool AddLost(std::uint64_t steps);
  /// Notes that `steps` more steps were left out after the last one in the file.
  bool AddLostAfter(std::uint64_t steps);
  /// Makes all added rows safe from a crash and visible to readers.
  bool Commit();
  /// Clears the error: new rows follow the last committed row. The next step must be a keyframe.
  void Resume();
  /// Commits and makes the recording one plain file. If another process has the file open, a -wal file stays
  /// beside it and `remark` says so.
  bool Close(std::string& remark);

  const std::string& file() const { return file_; }
  /// "lesson1.run: the disk is full".
  const std::string& error() const { return error_; }
  /// Writing failed because the disk is full; there may be room later.
  bool full() const { return full_; }
  /// Steps after the first frame, including uncommitted ones.
  std::uint64_t steps() const { return now_.steps; }
  /// Steps left out (AddLost()), including uncommitted ones.
  std::uint64_t lost() const { return now_.lost; }
  Nanoseconds begin() const { return begin_; }
  Nanoseconds end() const { return now_.end; }
  /// Rows were added since the last Commit().
  bool dirty() const { return dirty_; }
  /// Size of the file and its log, from the file system.
  std::uint64_t bytes() const;

 private:
  RunWriter(std::string file, RunWriterOptions options);

  bool Open(const SavedState& first);
  /// Calls `write()` in a transaction. If it throws, rolls back, sets error() and returns false.
  template <typename Write>
  bool Try(Write write);
  /// Writes the texts of models and textures that the file does not contain yet.
  void WriteTexts(const Scene& scene);
  void BeginScene(const Frame& frame);
  void WriteRow(const Frame& frame);
  void WriteImage(CameraShot shot);
  void WriteEvent(const Event& event);
  void EncodeShown(const Frame& frame);
  /// Fills commands_ with the set-points that differ from those in force, or with all of a new scene.
  void FindCommands(const Frame& frame, bool new_scene);
  bool IsShown(Nanoseconds time) const;

  const std::string file_;
  const RunWriterOptions options_;
  std::unique_ptr<Database> database_;
  struct Statements {
    Statement step, image, keyframe, input, event;
  };
  Statements insert_;  // declared after the database: destroyed first
  std::string error_;
  bool dirty_ = false, full_ = false;
  bool drew_none_ = false;  // a drawing failure has been reported
  Nanoseconds begin_ = 0;

  /// State that the rows so far leave for the next ones.
  struct Progress {
    TableEnds ends;
    std::shared_ptr<const Scene> scene;
    std::int64_t scene_number = 0;
    std::vector<SourceText> texts;    // of things added later: kinds and names
    std::vector<Setpoint> in_force;   // of scene->channels
    std::vector<bool> is_recomputed;  // of scene->robots: omit its controller's set-points
    std::uint64_t steps = 0, lost = 0, lost_after = 0, last_step = 0;
    Nanoseconds end = 0;
    Nanoseconds shown = -1;                                     // time of the last step with poses
    std::map<std::pair<int, std::size_t>, Nanoseconds> images;  // by robot and sensor: time of the last image
  };
  Progress now_, committed_;

  // Of the current step; members to reuse their memory.
  std::vector<CommandRecord> commands_;
  std::vector<SentMessage> messages_;
  std::vector<std::byte> commands_blob_, messages_blob_, channels_, distances_, targets_, poses_, scores_;
};

/// Why a recording may not be written to `file`; empty if it may. `overwrite` allows to replace only a
/// recording or an empty file.
std::string WhyNoRunFile(const std::string& file, bool overwrite);

/// Removes `file` and what SQLite keeps beside it.
void RemoveRunFile(const std::string& file);

/// The header of a recording that begins with `frame`; the caller fills in the rest (version, command,
/// started).
RunHeader HeaderOf(const Frame& frame, Mode mode, const RecordWhat& what, Nanoseconds pose_every);

}  // namespace coopdyn
