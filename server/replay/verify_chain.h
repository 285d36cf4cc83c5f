// SPDX-License-Identifier: MIT
// What the chains and the seal of a recording tell, in words: for the repetition of one, and for two that are
// compared. One thread, as the reader.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/record/run_chain.h"
#include "server/replay/verify.h"

namespace coopdyn {

/// A row of the run of `reader` that is not as it was written.
Difference DifferenceOf(const ChainDamage& damage, RunReader& reader);

/// "1 step is", "2 steps are".
std::string StepsAre(std::uint64_t count);

/// What was changed in the part of the run of `reader` from `first` to `last`, or in what it says of the run
/// as a whole; with the file's name and the row, or why it cannot be looked for. Empty: nothing, and no row
/// of that part is missing; or the file has no chains. Reads each row of it.
std::string WhyDamaged(RunReader& reader, std::uint64_t first, std::uint64_t last);

/// Goes along one recording that is not repeated.
class ChainCheck {
 public:
  /// Null with `error` if it cannot be read, or has no chains.
  static std::unique_ptr<ChainCheck> Begin(RunReader& reader, std::string& error);
  /// Looks at the rows up to `step`, if all before are as they were written.
  void GoTo(std::uint64_t step);
  /// Looks at all that is left. Returns the damage, with the file's name and the row, or why it cannot be
  /// looked for; empty: there is none.
  std::string Finish();
  /// The same, of WhyDamaged(). Instead of GoTo() and Finish().
  std::string CheckPart(std::uint64_t first, std::uint64_t last);

 private:
  ChainCheck(RunReader& reader, std::unique_ptr<RunChain> chain);
  std::string Tell(const std::string& ends) const;

  RunReader& reader_;
  std::unique_ptr<RunChain> chain_;
  std::string head_;  // what of meta and texts was changed
  std::optional<ChainDamage> damage_;
};

}  // namespace coopdyn
