// SPDX-License-Identifier: MIT
#include "server/replay/verify_chain.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

namespace coopdyn {

Difference DifferenceOf(const ChainDamage& damage, RunReader& reader) {
  const RunExtent extent = reader.extent();
  Difference difference;
  difference.step = difference.value_step = damage.step;
  const std::uint64_t step = std::min(damage.step, extent.last);
  std::optional<RecordedStep> row = reader.Read(step, true);
  if (!row) row = reader.Read(reader.NextShown(step, true).value_or(extent.first), true);  // it was lost
  difference.time = row ? row->time : extent.begin;
  difference.what = damage.what;
  difference.field = damage.field;
  difference.recorded = damage.recorded;
  difference.repeated = damage.computed;
  difference.exact = true;
  difference.of_file = true;
  difference.repeated_is = "computed";
  if (damage.field == "row") {
    difference.note = "it was taken out after it was written, or the row after it was put in";
    return difference;
  }
  difference.note =
      "it is not as it was written, or one before it was taken out, put in or moved; nothing that was "
      "repeated "
      "differs";
  if (step > extent.first && step == damage.step && !reader.Read(step - 1, true)) {
    difference.note += fmt::format("; there is no row of step {}", step - 1);
  }
  return difference;
}

std::string StepsAre(std::uint64_t count) {
  return fmt::format("{} {}", count, count == 1 ? "step is" : "steps are");
}

std::unique_ptr<ChainCheck> ChainCheck::Begin(RunReader& reader, std::string& error) {
  std::unique_ptr<RunChain> chain = RunChain::Open(reader.file(), error);
  if (chain == nullptr) return nullptr;
  std::unique_ptr<ChainCheck> check(new ChainCheck(reader, std::move(chain)));
  check->head_ = check->chain_->CheckHead();
  error = check->chain_->error();
  return error.empty() ? std::move(check) : nullptr;
}

ChainCheck::ChainCheck(RunReader& reader, std::unique_ptr<RunChain> chain)
    : reader_(reader), chain_(std::move(chain)) {}

void ChainCheck::GoTo(std::uint64_t step) {
  if (!damage_) damage_ = chain_->CheckRows(step);
  if (!damage_) damage_ = chain_->CheckKeyframes(step);
}

std::string ChainCheck::Finish() {
  std::string ends;
  if (!damage_) damage_ = chain_->CheckRest(ends);
  if (!chain_->error().empty()) return chain_->error();
  const std::string& file = reader_.file();
  if (damage_) {
    const Difference found = DifferenceOf(*damage_, reader_);
    const bool missing = damage_->field == "row";
    return fmt::format("{} is damaged from step {} on, t = {:g} s: {}: {}", file, found.step,
                       ToSeconds(found.time), found.what,
                       missing ? "it is missing, " + found.repeated
                               : fmt::format("its {} is {}, computed {}; it is not as it was written, or one "
                                             "before it was taken out, put in or moved",
                                             found.field, found.recorded, found.repeated));
  }
  if (ends.empty()) ends = head_;
  return ends.empty() ? "" : fmt::format("{}: {}: it is damaged", file, ends);
}

}  // namespace coopdyn
