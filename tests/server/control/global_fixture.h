// SPDX-License-Identifier: MIT
// Global modules on the real boards, with a stepping thread that applies edits on demand, and desks with real
// threads; no sockets, no physics.
#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/base/log.h"
#include "server/base/mutex.h"
#include "server/control/global_module.h"
#include "server/state/run_control.h"
#include "tests/server/base/temp_folder.h"
#include "tests/server/devices/fake_client.h"
#include "tests/server/devices/small_world.h"

namespace coopdyn {

/// A thread's queue, run by the test; other threads may post to it.
class TestThread {
 public:
  std::function<void(std::function<void()>)> poster() {
    return [this](std::function<void()> work) {
      {
        const MutexLock lock(mutex_);
        posted_.push_back(std::move(work));
      }
      changed_.NotifyAll();
    };
  }
  /// Runs the queued functions.
  void Run() {
    while (std::function<void()> work = Take(false)) work();
  }
  /// Runs queued functions until `condition` holds; if it never does, the test's time limit ends the wait.
  template <typename Condition>
  void RunUntil(Condition condition) {
    while (!condition()) Take(true)();
  }

 private:
  std::function<void()> Take(bool wait) {
    const MutexLock lock(mutex_);
    while (wait && posted_.empty()) changed_.Wait(mutex_);
    if (posted_.empty()) return nullptr;
    std::function<void()> work = std::move(posted_.front());
    posted_.pop_front();
    return work;
  }

  Mutex mutex_;
  ConditionVariable changed_;
  std::deque<std::function<void()>> posted_ GUARDED_BY(mutex_);
};

class GlobalModuleTest : public testing::Test {
 protected:
  /// Applies the pending edits, as the stepping thread does; keeps all in applied_.
  void ApplyEdits() {
    for (Edit& each : edits_.TakeAll()) {
      EditResult result = next_result_;
      if (result.error == Error::kOk) {
        if (const auto* set = As<edit::SetJournal>(each.action)) SetJournal(set->journal);
        if (As<edit::Save>(each.action) != nullptr) result.saved = State();
        const auto* note = As<edit::Note>(each.action);
        if (note != nullptr && journal_ != nullptr) {
          const FramePtr frame = world_.frames.Latest();
          journal_->Note({frame->step, frame->time_s(), "note", note->text});
        }
      }
      result.frame = world_.frames.Latest();
      if (each.done) each.done(result);
      applied_.push_back(std::move(each.action));
    }
  }
  /// Waits until another thread has pushed an edit.
  void WaitForEdit() {
    while (true) {
      const std::uint64_t seen = bell_.count();
      if (!edits_.empty()) return;
      bell_.WaitUntil(seen, std::numeric_limits<Nanoseconds>::max());
    }
  }
  void SetJournal(RunJournal* journal) {
    journal_ = journal;
    if (journal_ != nullptr) journal_->Begin(State());
  }
  SavedStatePtr State() const {
    auto state = std::make_shared<SavedState>();
    state->frame = world_.frames.Latest();
    return state;
  }
  /// Runs a step and records it.
  void Step() {
    world_.Step();
    if (journal_ == nullptr) return;
    const FramePtr frame = world_.frames.Latest();
    std::shared_ptr<SavedState> keyframe;
    if (journal_->WantsKeyframe(frame->step)) {
      keyframe = std::make_shared<SavedState>();
      keyframe->frame = frame;
      keyframe->mode = Mode::kLockstep;
    }
    journal_->Step(frame, Mode::kLockstep, keyframe, 0);
  }
  /// Sends a line, applies its edits, and waits for the reply.
  Message Ask(FakeClient& client, const std::string& line) {
    client.Send(line);
    ApplyEdits();
    thread_.RunUntil([&] { return !client.is_waiting(); });
    return client.received.back();
  }

  template <typename T>
  const T& LastEdit() {
    return *As<T>(applied_.back());
  }

  const TempFolder temp_folder_;
  const std::filesystem::path& folder_ = temp_folder_.path();
  ManualClock clock_;
  Logger logger_ = NullLogger();
  ConnectionRoster roster_;
  TokenGuard guard_{"secret", true};
  Doorbell bell_;
  EditQueue edits_{bell_};
  RunControl run_;
  SmallWorld world_{2};
  RunJournal* journal_ = nullptr;
  TestThread thread_;
  EditResult next_result_;
  std::vector<EditAction> applied_;
  GlobalServices services_{world_.board, world_.frames, edits_, roster_, guard_, clock_, "1.2.3"};
};

}  // namespace coopdyn
