// SPDX-License-Identifier: MIT
// The world changes that can be undone or redone. Used by the holder of the step baton.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "server/state/world_change.h"

namespace coopdyn {

class WorldHistory {
 public:
  static constexpr std::size_t kMaxChanges = 20'000;  // beyond that the oldest are forgotten

  struct Entry {
    WorldChange change, inverse;
    std::uint64_t epoch = 0, step = 0;  // of the frame that it changed
  };

  /// A change was made: forgets the changes that could be redone.
  void Note(Entry entry) {
    redo_.clear();
    Push(std::move(entry));
  }
  bool can_undo() const { return !undo_.empty(); }
  bool can_redo() const { return !redo_.empty(); }
  std::size_t undo_count() const { return undo_.size(); }
  std::size_t redo_count() const { return redo_.size(); }

  /// The change that undoes the last one, at the frame of this epoch and step. If undone at once, neighbours
  /// go back to sleep; later they stay awake. @pre can_undo()
  WorldChange NextUndo(std::uint64_t epoch, std::uint64_t step) const {
    const Entry& last = undo_.back();
    WorldChange change = last.inverse;
    if (last.epoch != epoch || last.step != step) change.rests.clear();
    change.label = "undo " + last.change.label;
    return change;
  }
  /// @pre can_redo()
  WorldChange NextRedo() const {
    WorldChange change = redo_.back();
    change.label = "redo " + change.label;
    return change;
  }
  /// The change of NextUndo() was made.
  void NoteUndone() {
    redo_.push_back(std::move(undo_.back().change));
    undo_.pop_back();
  }
  /// The change of NextRedo() was made, as `entry`.
  void NoteRedone(Entry entry) {
    entry.change = std::move(redo_.back());
    redo_.pop_back();
    Push(std::move(entry));
  }
  /// A reset has restored the start: every change can be redone.
  void NoteReset() {
    while (!undo_.empty()) NoteUndone();
  }
  void Clear() {
    undo_.clear();
    redo_.clear();
  }

 private:
  void Push(Entry entry) {
    undo_.push_back(std::move(entry));
    if (undo_.size() > kMaxChanges) undo_.pop_front();
  }

  std::deque<Entry> undo_;
  std::vector<WorldChange> redo_;  // the next one is last
};

}  // namespace coopdyn
