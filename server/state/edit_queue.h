// SPDX-License-Identifier: MIT
// Changes to the run or the world that apply between two steps, in order of arrival. Any thread pushes; the
// stepping thread takes and applies them, and calls back.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/message.h"
#include "server/base/mutex.h"
#include "server/state/command_board.h"
#include "server/state/doorbell.h"
#include "server/state/edits.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Why an edit of a playback is refused in a live run (error 5).
inline constexpr const char* kNotPlayingText = "nothing is being played: coopdyn play RUN plays a recording";

struct EditResult {
  Error error = Error::kOk;
  std::string text;
  FramePtr frame = nullptr;               // the newest frame after the edit
  SavedStatePtr saved = nullptr;          // result of Save
  WorldChange change = {};                // of a SceneEdit: the resulting change
  std::vector<std::int32_t> params = {};  // of the reply
};

struct Edit {
  EditAction action;
  /// Called once on the stepping thread, without locks; for Step only on refusal. May be null.
  std::function<void(const EditResult&)> done = nullptr;
  /// For Step: called when its steps have run, or were cancelled by pause, reset or load. May be null.
  StepDone stepped = nullptr;
};

class EditQueue {
 public:
  explicit EditQueue(Doorbell& bell) : bell_(bell) {}
  /// Any thread. After Close() the edit is answered at once with error 5.
  void Push(Edit edit) EXCLUDES(mutex_) {
    if (const auto why = Add(edit)) Refuse(edit, *why);
    bell_.Ring();
  }
  /// Removes and returns all waiting edits, in order. Stepping thread.
  std::vector<Edit> TakeAll() EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return std::exchange(edits_, {});
  }
  /// Removes and returns the first waiting edit, if any. Stepping thread.
  std::optional<Edit> TakeNext() EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    if (edits_.empty()) return std::nullopt;
    std::optional<Edit> next = std::move(edits_.front());
    edits_.erase(edits_.begin());
    return next;
  }
  bool empty() const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    return edits_.empty();
  }
  /// Refuses waiting and later edits with this text.
  void Close(std::string why = "the daemon is stopping") EXCLUDES(mutex_) {
    std::vector<Edit> refused;
    {
      const MutexLock lock(mutex_);
      closed_ = true;
      why_ = why;
      refused.swap(edits_);
    }
    for (const Edit& edit : refused) Refuse(edit, why);
  }

 private:
  /// Appends the edit; if the queue is closed, leaves the edit and returns the reason.
  std::optional<std::string> Add(Edit& edit) EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    if (closed_) return why_;
    edits_.push_back(std::move(edit));
    return std::nullopt;
  }
  static void Refuse(const Edit& edit, const std::string& why) {
    if (edit.done) edit.done({Error::kNotPossible, why});
  }

  Doorbell& bell_;
  mutable Mutex mutex_;
  std::vector<Edit> edits_ GUARDED_BY(mutex_);
  bool closed_ GUARDED_BY(mutex_) = false;
  std::string why_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
