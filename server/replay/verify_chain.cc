// SPDX-License-Identifier: MIT
#include "server/replay/verify_chain.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

namespace coopdyn {

Difference DifferenceOf(const ChainDamage& damage, RunReader& reader) {
  const RunExtent extent = reader.extent();
  const std::uint64_t step = std::min(damage.step, extent.last);
  std::optional<RecordedStep> row = reader.Read(step, true);
  if (!row) row = reader.Read(reader.NextShown(step, true).value_or(extent.first), true);  // a lost step
  Difference difference{damage.step,
                        row ? row->time : extent.begin,
                        damage.what,
                        damage.field,
                        damage.recorded,
                        damage.computed,
                        true,
                        true};
  difference.repeated_is = "computed";
  if (damage.field == "row") {
    difference.note = "it was taken out after it was written, or the row after it was put in";
    return difference;
  }
  difference.note =
      "it is not as it was written, or one before it was taken out, put in or moved; nothing that was "
      "repeated differs";
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
  return Tell(ends);
}

std::string ChainCheck::CheckPart(std::uint64_t first, std::uint64_t last) {
  std::string ends;
  const RunExtent extent = reader_.extent();
  const bool from_start = first <= extent.first, to_end = last >= extent.last;
  if (!from_start && !chain_->SkipTo(first)) return Tell(ends);
  damage_ = to_end ? chain_->CheckRest(ends) : chain_->CheckRowsAround(last, ends);
  // A damaged page may also hide which rows are the first and the last.
  const auto step = [](std::uint64_t number) { return static_cast<std::int64_t>(number); };
  const bool other_start = from_start && chain_->first_step() != step(extent.first);
  const bool other_end = to_end && !reader_.growing() && chain_->last_step() != step(extent.last);
  if (ends.empty() && (other_start || other_end)) {
    ends = fmt::format("its steps are found to be {} to {}, and {} to {}", extent.first, extent.last,
                       chain_->first_step(), chain_->last_step());
  }
  return Tell(ends);
}

std::string WhyDamaged(RunReader& reader, std::uint64_t first, std::uint64_t last) {
  if (!RunChain::IsChained(reader.file())) return {};
  std::string error;
  const std::unique_ptr<ChainCheck> check = ChainCheck::Begin(reader, error);
  return check == nullptr ? error : check->CheckPart(first, last);
}

std::string ChainCheck::Tell(const std::string& ends) const {
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
  const std::string& other = ends.empty() ? head_ : ends;
  return other.empty() ? "" : fmt::format("{}: {}: it is damaged", file, other);
}

}  // namespace coopdyn
