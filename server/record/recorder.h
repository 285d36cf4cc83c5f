// SPDX-License-Identifier: MIT
// Writes a run to a file as it happens, on its own thread behind a bounded queue. In lockstep and free mode
// the run waits for a disk that does not keep up. In real time steps are left out, counted and reported, and
// the next written step is a keyframe, so that the following steps can be verified. When the disk is full the
// run continues unrecorded, and the recording resumes once there is room. The holder of the baton calls the
// RunJournal functions; any thread may call the rest.
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
  std::string file;                // "lesson1.run"; continues in lesson1-2.run after a reset or load
  std::optional<RecordWhat> what;  // empty: DefaultRecordWhat()
  Nanoseconds pose_every = 0;      // interval of poses and readings; 0: each step
  DrawImage draw;                  // draws camera images, if `what` has images
  bool overwrite = false;          // `file` only, if it is a recording
  bool durable = false;            // except in real time, each step is on the disk before it is answered
  std::string version, command, started;
  std::size_t max_queue_bytes = std::size_t{64} << 20;
  std::uint64_t keyframe_steps = 500;
  Nanoseconds commit_every = 100'000'000;             // wall clock; well below CrashCost::age
  Nanoseconds retry_every = kNanosecondsPerSecond;    // wall clock: how often to check for free space
  std::uint64_t room_bytes = std::uint64_t{4} << 20;  // free bytes needed on the disk
  /// Free bytes on the disk of `file`; for tests. Recorder's thread.
  std::function<std::uint64_t(const std::string& file)> free_bytes;
  /// Called once, on the recorder's thread, when it can write no more; `text` says why and what was recorded.
  std::function<void(const std::string& text)> on_failure;
  /// Called on the recorder's thread when the disk is full, and when there is room again.
  std::function<void(const std::string& text)> on_stall, on_room;
};

struct RecorderStatus {
  std::string file;                // the current one, from Begin() on
  std::uint64_t steps = 0;         // written to it
  std::uint64_t lost = 0;          // left out, in real time or because the disk was full
  std::uint64_t bytes = 0;         // of the file
  Nanoseconds begin = 0, end = 0;  // simulated
  std::string failure;             // empty while recording
  std::string stall;               // why nothing is written for now; empty while writing
  double cpu_s = 0;                // CPU time of the recorder's thread
};

class Recorder final : public RunJournal {
 public:
  /// Writes nothing before Begin(). `clock` must outlive the recorder.
  Recorder(RecorderOptions options, const Clock& clock, Logger logger);
  /// Calls Close().
  ~Recorder() override;

  /// Checks that `file` can be made; returns an error text, empty if it can. Before Begin().
  std::string Check() const;
  /// Writes the queued items and makes the recording one plain file. After the last RunJournal call.
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
