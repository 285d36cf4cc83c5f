// SPDX-License-Identifier: MIT
// Writes a run to a file while it goes on: a thread of its own behind a bounded queue. In lockstep and free
// mode the run waits for a disk that does not keep up; in real time steps are left out, counted and said, and
// the next one written is a keyframe, so that what follows can be verified. The same when there is no room:
// the run goes on without being recorded, and the recording goes on when there is room again. Calls of
// RunJournal by the holder of the step baton, the rest by any thread.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/record/run_header.h"
#include "server/state/image_board.h"
#include "server/state/run_journal.h"

namespace coopdyn {

struct RecorderOptions {
  std::string file;                // "lesson1.run"; after a reset or load it goes on in lesson1-2.run
  std::optional<RecordWhat> what;  // empty: DefaultRecordWhat()
  Nanoseconds pose_every = 0;      // interval of poses and readings; 0: each step
  DrawImage draw;                  // of cameras, if `what` has images
  bool overwrite = false;          // `file` itself, if it is a recording
  bool durable = false;            // each step is on the disk before it is answered, but for real time
  std::string version, command, started;
  std::size_t max_queue_bytes = std::size_t{64} << 20;
  std::uint64_t keyframe_steps = 500;
  Nanoseconds commit_every = 100'000'000;             // wall clock; well below what a crash may cost
  Nanoseconds retry_every = kNanosecondsPerSecond;    // wall clock: how often it looks for room
  std::uint64_t room_bytes = std::uint64_t{4} << 20;  // free on the disk, at least
  /// Free bytes on the disk of `file`; for tests. Recorder's thread.
  std::function<std::uint64_t(const std::string& file)> free_bytes;
  /// Called on the recorder's thread, once, when it can write no more; `text` says why and what is there.
  std::function<void(const std::string& text)> on_failure;
  /// Called on the recorder's thread when there is no room, and when there is some again.
  std::function<void(const std::string& text)> on_stall, on_room;
};

struct RecorderStatus {
  std::string file;                // the present one, at once after Begin()
  std::uint64_t steps = 0;         // written to it
  std::uint64_t lost = 0;          // left out, in real time or for want of room
  std::uint64_t bytes = 0;         // of the file
  Nanoseconds begin = 0, end = 0;  // simulated
  std::string failure;             // empty: it goes on
  std::string stall;               // why nothing is written for now; empty: it is
  double cpu_s = 0;                // used by its thread
};

class Recorder final : public RunJournal {
 public:
  /// Nothing is written before Begin(). Clock and logger outlive it.
  Recorder(RecorderOptions options, const Clock& clock, Logger logger);
  /// Close().
  ~Recorder() override;

  /// Makes sure that `file` can be made: an error text, empty if so. Before Begin().
  std::string Check() const;
  /// Writes what waits and makes the file one plain file. After the last call as a journal.
  void Close();
  RecorderStatus status() const;

  void Begin(const SavedStatePtr& state) override;
  bool WantsKeyframe(std::uint64_t step) override;
  void Step(const FramePtr& frame, Mode mode, SavedStatePtr keyframe, Nanoseconds now) override;
  void Input(RunInput input) override;
  void Note(Event event) override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coopdyn
