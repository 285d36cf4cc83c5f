// SPDX-License-Identifier: MIT
#include "server/state/edit_queue.h"

#include <optional>
#include <utility>

namespace coopdyn {

namespace {

void Refuse(const Edit& edit) {
  if (edit.done) edit.done({Error::kNotPossible, "the daemon is stopping", nullptr});
}

}  // namespace

void EditQueue::Push(Edit edit) {
  std::optional<Edit> refused;
  {
    const MutexLock lock(mutex_);
    if (closed_) {
      refused = std::move(edit);
    } else {
      edits_.push_back(std::move(edit));
    }
  }
  if (refused) Refuse(*refused);
  bell_.Ring();
}

std::vector<Edit> EditQueue::TakeAll() {
  const MutexLock lock(mutex_);
  return std::exchange(edits_, {});
}

std::optional<Edit> EditQueue::TakeNext() {
  const MutexLock lock(mutex_);
  if (edits_.empty()) return std::nullopt;
  std::optional<Edit> next = std::move(edits_.front());
  edits_.erase(edits_.begin());
  return next;
}

bool EditQueue::empty() const {
  const MutexLock lock(mutex_);
  return edits_.empty();
}

void EditQueue::Close() {
  std::vector<Edit> refused;
  {
    const MutexLock lock(mutex_);
    closed_ = true;
    refused.swap(edits_);
  }
  for (const Edit& edit : refused) Refuse(edit);
}

}  // namespace coopdyn
