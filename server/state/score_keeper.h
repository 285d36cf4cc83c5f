// SPDX-License-Identifier: MIT
// The scores of a run, from frame to frame: what [SCORE_n] asks for. A run without scores costs nothing. The
// stepping thread's.
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
  /// Begins anew with `frame`, the start of a run; fills in its scores.
  void Begin(Frame& frame);
  /// Looks at `frame`, which follows the last one, and fills in its scores.
  void AddTo(Frame& frame);
  /// `now`, a frame after an edit: who is there may have changed. Fills in its scores.
  void Refit(Frame& now);

  /// All that the scores are made from, for Restore().
  std::vector<double> Save() const;
  /// Goes on from what was saved at `frame`; begins anew there, and says false, if it does not fit.
  bool Restore(Frame& frame, std::span<const double> saved);

 private:
  /// A robot or a thing that a score is of.
  struct Subject {
    std::int32_t id = 0;  // WorldId
    int index = 0;        // in the scene
    int part = -1;        // of the links of the robot's file; -1: itself
    bool marked = false;  // it was there, it has fallen
    double x = 0, y = 0;  // where it was last, or at the start
  };
  struct Book {
    ScoreEntry entry;
    std::vector<Subject> subjects;  // by id
    double sum = 0;                 // of what the score adds up; of `nearest` the least so far
    std::set<std::pair<std::int32_t, std::int32_t>> pairs;  // in touch, or cells that were covered
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

/// The score that ends the run at `frame` by its `until` or `limit`: its index; -1: none does.
int EndingScore(const Frame& frame);

}  // namespace coopdyn
