// SPDX-License-Identifier: MIT
#include "server/record/run_chain.h"

#include <algorithm>
#include <utility>

#include "server/record/step_row.h"

namespace coopdyn {

namespace {

/// Rows per read transaction: a writer waits for readers before it can truncate its log.
constexpr int kLinksAtOnce = 500;
constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();

/// True if the rows of `table` are numbered 1, 2, …; false if by steps, of which some may be missing.
bool IsNumbered(ChainedTableIndex table) {
  return kChainedTables[table].step_column != 0;
}

/// The step that a row of `table` belongs to; at least 0 even in a damaged file.
std::uint64_t StepOf(ChainedTableIndex table, const Statement& row) {
  const std::int64_t step = std::max<std::int64_t>(0, row.integer(kChainedTables[table].step_column));
  return static_cast<std::uint64_t>(step);
}

std::string NameOf(ChainedTableIndex table, std::int64_t id) {
  const std::string number = std::to_string(id);
  if (table == kStepTable) return "the row of step " + number;
  if (table == kKeyframeTable) return "the keyframe of step " + number;
  return kChainedTables[table].name + (" " + number);
}

/// The content of a column that should contain a chain.
std::string ChainText(const Statement& row, int column) {
  switch (row.kind(column)) {
    case Statement::Kind::kNull:
      return "NULL";
    case Statement::Kind::kInteger:
      return row.text(column);
    default:
      return "no whole number";
  }
}

}  // namespace

std::unique_ptr<RunChain> RunChain::Open(const std::string& file, std::string& error) {
  std::unique_ptr<RunChain> chain(new RunChain);
  chain->database_ = Database::Open(file, Database::Access::kReadOnly, error);
  if (chain->database_ == nullptr) return nullptr;
  chain->Prepare();
  error = chain->error_;
  return error.empty() ? std::move(chain) : nullptr;
}

bool RunChain::IsChained(const std::string& file) try {
  std::string error;
  const auto database = Database::Open(file, Database::Access::kReadOnly, error);
  if (database != nullptr) database->Prepare("SELECT chain FROM step");
  return true;
} catch (const DatabaseError& failed) {
  return failed.busy() || failed.damaged();
}

void RunChain::Prepare() try {
  for (std::size_t i = 0; i < walks_.size(); ++i) {
    const ChainedTable& table = kChainedTables[i];
    std::string columns = table.columns;
    if (i == kStepTable && !StepColumns::HasScores(*database_)) columns.erase(columns.rfind(", scores"));
    const std::string id = columns.substr(0, columns.find(','));
    walks_[i].rows = database_->Prepare("SELECT " + columns + ", chain FROM " + table.name + " WHERE " + id +
                                        " > ?1 ORDER BY " + id + " LIMIT " + std::to_string(kLinksAtOnce));
  }
} catch (const DatabaseError& failed) {
  if (failed.busy() || failed.damaged()) return FailReading(failed, "");
  error_ = std::string(failed.what()) + ": without a chain of its rows a recording cannot tell whether it " +
           "was changed: it was made by another program, or its start is damaged; copy it again, or record " +
           "it again";
}

template <typename Read>
auto RunChain::Guard(Read read) -> decltype(read()) {
  // One consistent snapshot, although a writer may add rows.
  database_->Try("BEGIN");
  decltype(read()) found{};
  try {
    found = read();
  } catch (const DatabaseError& failed) {
    FailReading(failed, "");
  }
  database_->Try("COMMIT");
  return found;
}

std::string RunChain::CheckHead() {
  return Guard([this]() -> std::string {
    const bool sealed = IsSealed(*database_);
    const auto recorded =
        database_->Integer("SELECT value FROM meta WHERE key = 'texts' AND typeof(value) = 'integer'");
    if (recorded != TextsChain(*database_)) {
      return "a text that it carries (scenario, world or robot) was changed after it was written";
    }
    return sealed ? "" : "its table meta was changed after it was written";
  });
}

bool RunChain::SkipTo(std::uint64_t step) {
  return Guard([this, step] {
    const std::optional<std::int64_t> keyframe =
        database_->Integer("SELECT max(step) FROM keyframe WHERE step <= ?", step);
    for (const ChainedTableIndex table : {kStepTable, kKeyframeTable}) {
      Statement before =
          database_->Prepare("SELECT step, chain FROM " + std::string(kChainedTables[table].name) +
                             " WHERE step < ?1 ORDER BY step DESC LIMIT 1");
      before.Bind(1, keyframe);
      if (!before.Step()) continue;
      walks_[table].after = before.integer(0);
      walks_[table].chain.Restart(static_cast<std::int32_t>(before.integer(1)));
    }
    return true;
  });
}

std::optional<ChainDamage> RunChain::CheckRows(std::uint64_t step) {
  std::optional<ChainDamage> first;
  for (const ChainedTableIndex table : {kStepTable, kSceneTable, kInputTable, kEventTable}) {
    std::optional<ChainDamage> damage = Go(table, step);
    if (damage && (!first || damage->step < first->step)) first = std::move(damage);
  }
  return first;
}

std::optional<ChainDamage> RunChain::CheckKeyframes(std::uint64_t step) {
  return Go(kKeyframeTable, step);
}

std::optional<ChainDamage> RunChain::CheckRowsAround(std::uint64_t step, std::string& ends) {
  const std::optional<std::int64_t> next =
      Guard([&] { return database_->Integer("SELECT min(step) FROM step WHERE step > ?", step); });
  ends.clear();
  if (!error_.empty()) return std::nullopt;
  if (!next) return CheckRest(ends);
  std::optional<ChainDamage> damage = CheckRows(static_cast<std::uint64_t>(*next));
  if (!damage && error_.empty() && last_step() != *next) {
    // On a damaged page a row with a wrong number ends the walk, although a search finds the right row.
    ends = "the rows after step " + std::to_string(last_step()) + " are not where they belong";
    return std::nullopt;
  }
  return damage ? damage : CheckKeyframes(step);
}

std::optional<ChainDamage> RunChain::CheckRest(std::string& ends) {
  ends.clear();
  // One transaction: meta's ends match the rows of one moment.
  return Guard([this, &ends] {
    std::optional<ChainDamage> first = CheckRows(kAll);
    std::optional<ChainDamage> keyframe = CheckKeyframes(kAll);
    if (keyframe && (!first || keyframe->step < first->step)) first = std::move(keyframe);
    if (!first && error_.empty()) ends = CompareEnds();
    return first;
  });
}

std::string RunChain::CompareEnds() const {
  const std::optional<std::string> recorded =
      database_->Text("SELECT value FROM meta WHERE key = 'ends' AND typeof(value) = 'text'");
  if (!recorded) return "its table meta does not say where its tables end";
  for (std::size_t i = 0; i < walks_.size(); ++i) {
    const TableEnd end = walks_[i].end();
    if ((", " + *recorded + ",").find(", " + EndText(i, end) + ",") != std::string::npos) continue;
    return "its table " + std::string(kChainedTables[i].name) + " ends with row " + std::to_string(end.id) +
           ", where meta tells of another end: rows after it are missing";
  }
  return {};
}

std::optional<ChainDamage> RunChain::Go(ChainedTableIndex table, std::uint64_t step) {
  Walk& walk = walks_[table];
  if (step < walk.waits_for || !error_.empty()) return std::nullopt;
  std::optional<ChainDamage> damage;
  try {
    for (int count = kLinksAtOnce; count == kLinksAtOnce && !damage;) {
      bool more = true;
      walk.rows.Bind(1, walk.after);
      for (count = 0; !damage && (more = walk.rows.Step()); ++count) {
        // In a damaged file rows may be in any order.
        if (walk.rows.integer(0) <= walk.after)
          throw DatabaseError(database_->file() + ": rows out of order");
        walk.waits_for = StepOf(table, walk.rows);
        if (walk.waits_for > step) break;
        damage = CheckRow(table);
      }
      // No row follows the last one, unless the file grows.
      if (!more && count < kLinksAtOnce) walk.waits_for = kAll;
      walk.rows.Reset();
    }
  } catch (const DatabaseError& failed) {
    walk.rows.Reset();
    FailReading(failed, walk.after == kNone ? std::string("the start of table ") + kChainedTables[table].name
                                            : NameOf(table, walk.after));
  }
  return damage;
}

std::optional<ChainDamage> RunChain::CheckRow(ChainedTableIndex table) {
  Walk& walk = walks_[table];
  const Statement& row = walk.rows;
  const int columns = row.columns() - 1;  // without the chain
  const std::int64_t id = row.integer(0), before = walk.end().id;
  walk.chain.AddColumns(row, columns);
  if (table == kSceneTable) AddSceneParts(*database_, id, walk.chain);
  const std::int32_t computed = walk.chain.Link();
  walk.after = id;
  if (table == kStepTable && first_step_ < 0) first_step_ = id;
  if (row.is_integer(columns) && row.integer(columns) == computed) return std::nullopt;
  walk.chain.Restart(static_cast<std::int32_t>(row.integer(columns)));
  ChainDamage damage;
  damage.step = StepOf(table, row);
  if (IsNumbered(table) && id > before + 1) {
    damage.what = NameOf(table, before + 1);
    damage.field = "row";
    damage.recorded = "missing";
    damage.computed = NameOf(table, id) + " was not written " +
                      (before == 0 ? "as the first" : "after " + NameOf(table, before));
    return damage;
  }
  damage.what = NameOf(table, id);
  damage.field = "chain";
  damage.recorded = ChainText(row, columns);
  damage.computed = std::to_string(computed);
  return damage;
}

void RunChain::FailReading(const DatabaseError& failed, const std::string& where) {
  error_ = failed.what() + (where.empty() ? "" : ", after " + where) +
           (failed.busy() ? ": another program holds it, try again"
                          : ": the file is damaged there, copy it again from where it was recorded");
}

}  // namespace coopdyn
