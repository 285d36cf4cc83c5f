// SPDX-License-Identifier: MIT
// Computes the scores of a run ([SCORE_n]) from frame to frame. Costs nothing in a run without scores.
// Stepping thread.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "server/model/scores.h"
#include "server/state/frame.h"

namespace coopdyn {

class ScoreKeeper {
 public:
  /// Starts afresh with `frame`, the start of a run, and fills in its scores.
  void Begin(Frame& frame);
  /// Evaluates `frame`, which follows the last one, and fills in its scores.
  void AddTo(Frame& frame);
  /// Adapts to `now`, a frame after an edit that may have added or removed subjects. Fills in its scores.
  void Refit(Frame& now);

  /// The state that Restore() needs.
  std::vector<double> Save() const;
  /// Continues from the state saved at `frame`. If it does not fit, starts afresh and returns false.
  bool Restore(Frame& frame, std::span<const double> saved);

 private:
  /// A robot or thing that a score counts.
  struct Subject {
    std::int32_t id = 0;  // WorldId
    int index = 0;        // in the scene
    int part = -1;        // among the link frames of the robot's file; -1: the whole robot
    bool marked = false;  // has reached the target, or has fallen
    double x = 0, y = 0;  // at the last look, or at the start
  };
  struct Book {
    ScoreEntry entry;
    std::vector<Subject> subjects;                          // by id
    double sum = 0;                                         // running total; for `nearest` the minimum so far
    std::set<std::pair<std::int32_t, std::int32_t>> pairs;  // ids in contact, or covered cells
  };

  void Use(const Frame& frame);
  std::vector<Subject> SubjectsOf(const ScoreEntry& entry, const Scene& scene) const;
  /// `follows`: a step has passed since the last look.
  void Look(Book& book, const Frame& frame, bool follows);
  double ValueOf(const Book& book, const Frame& frame) const;
  void Fill(Frame& frame) const;

  std::shared_ptr<const Scene> scene_;
  std::vector<Book> books_;
};

/// Index of the score that ends the run at `frame`, by its `until` or `limit`; -1 if none.
int EndingScore(const Frame& frame);

}  // namespace coopdyn
