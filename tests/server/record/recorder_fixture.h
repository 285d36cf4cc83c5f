// SPDX-License-Identifier: MIT
// A recorder of made-up frames, with a clock controlled by the test. One test at a time; GateClock: any
// thread.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <thread>

#include "record_fixture.h"
#include "server/base/mutex.h"
#include "server/record/recorder.h"

namespace coopdyn {

/// The recorder reads the time after each step that it writes: a closed gate holds it there.
class GateClock final : public Clock {
 public:
  Nanoseconds Now() const override {
    const MutexLock lock(mutex_);
    ++waiting_;
    changed_.NotifyAll();
    while (closed_) changed_.Wait(mutex_);
    --waiting_;
    return now_;
  }
  void CloseGate() {
    const MutexLock lock(mutex_);
    closed_ = true;
  }
  void OpenGate() {
    const MutexLock lock(mutex_);
    closed_ = false;
    changed_.NotifyAll();
  }
  /// Waits until a thread stands at the closed gate.
  void AwaitWaiter() {
    const MutexLock lock(mutex_);
    while (waiting_ == 0) changed_.Wait(mutex_);
  }
  void Advance(Nanoseconds by) {
    const MutexLock lock(mutex_);
    now_ += by;
  }
  /// Reads the time whether the gate is closed or not.
  Nanoseconds Peek() const {
    const MutexLock lock(mutex_);
    return now_;
  }

 private:
  mutable Mutex mutex_;
  mutable ConditionVariable changed_;
  mutable int waiting_ GUARDED_BY(mutex_) = 0;
  bool closed_ GUARDED_BY(mutex_) = false;
  Nanoseconds now_ GUARDED_BY(mutex_) = 0;
};

class RecorderTest : public testing::Test {
 protected:
  RecorderOptions Options() {
    RecorderOptions options;
    options.file = file_;
    options.version = "1.2.3";
    options.what = RecordWhat();
    options.commit_every = 0;  // immediately
    return options;
  }
  /// The queue has room for this number of steps.
  RecorderOptions WithRoomFor(std::size_t steps) {
    const auto frame = maker_.Make(0);
    const std::size_t bytes = sizeof(Frame) + frame->bodies.size() * sizeof(BodyState) +
                              frame->channels.size() * sizeof(ChannelState);
    RecorderOptions options = Options();
    options.max_queue_bytes = steps * bytes + bytes / 2;
    return options;
  }
  /// Adds a step, as the stepping thread does.
  void Step(Recorder& recorder, std::uint64_t step, Mode mode) {
    const FramePtr frame = maker_.Make(step);
    recorder.Step(frame, mode, ExactIf(recorder.WantsKeyframe(step), frame, mode), clock_.Peek());
  }
  void Steps(Recorder& recorder, std::uint64_t first, std::uint64_t last, Mode mode) {
    for (std::uint64_t step = first; step <= last; ++step) Step(recorder, step, mode);
  }
  /// Begins a run, writes step 1, and holds the recorder there: later steps wait in the queue.
  void BeginAndHold(Recorder& recorder, Mode mode) {
    clock_.CloseGate();
    recorder.Begin(maker_.Start());
    while (recorder.status().bytes == 0) std::this_thread::yield();
    Step(recorder, 1, mode);
    clock_.AwaitWaiter();
  }

  TempFolder folder_;
  const std::string file_ = folder_.File("lesson1.run");
  FrameMaker maker_{RecordScene()};
  GateClock clock_;
};

}  // namespace coopdyn
