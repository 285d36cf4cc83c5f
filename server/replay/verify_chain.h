// SPDX-License-Identifier: MIT
// Reports damage that the chains and the seal of a recording show, for verifying one recording and for
// comparing two. One thread, the reader's.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/record/run_chain.h"
#include "server/replay/verify.h"

namespace coopdyn {

/// Describes a damaged row of the run of `reader`.
Difference DifferenceOf(const ChainDamage& damage, RunReader& reader);

/// "1 step is", "2 steps are".
std::string StepsAre(std::uint64_t count);

/// Describes a change in the steps `first` to `last` of the run of `reader` or in its header, with the file's
/// name and the row, or why the check failed. Empty if no row of that part was changed or is missing, or if
/// the file has no chains. Reads each row of that part.
std::string WhyDamaged(RunReader& reader, std::uint64_t first, std::uint64_t last);

/// Checks the chains of a recording that is not repeated.
class ChainCheck {
 public:
  /// Null with `error` if the file cannot be read or has no chains.
  static std::unique_ptr<ChainCheck> Begin(RunReader& reader, std::string& error);
  /// Checks the rows up to `step`, unless damage was found before.
  void GoTo(std::uint64_t step);
  /// Checks the remaining rows. Returns the damage with the file's name and the row, or why the check failed;
  /// empty if there is no damage.
  std::string Finish();
  /// Implements WhyDamaged(). Use instead of GoTo() and Finish().
  std::string CheckPart(std::uint64_t first, std::uint64_t last);

 private:
  ChainCheck(RunReader& reader, std::unique_ptr<RunChain> chain);
  std::string Tell(const std::string& ends) const;

  RunReader& reader_;
  std::unique_ptr<RunChain> chain_;
  std::string head_;  // the change of table meta or the texts; or empty
  std::optional<ChainDamage> damage_;
};

}  // namespace coopdyn
