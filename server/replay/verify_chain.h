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

 private:
  ChainCheck(RunReader& reader, std::unique_ptr<RunChain> chain);

  RunReader& reader_;
  std::unique_ptr<RunChain> chain_;
  std::string head_;  // what of meta and texts was changed
  std::optional<ChainDamage> damage_;
};

}  // namespace coopdyn
