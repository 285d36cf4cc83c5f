// SPDX-License-Identifier: MIT
#include "server/record/run_seal.h"

#include "server/record/run_tables.h"

namespace coopdyn {

namespace {

/// Chains all rows of `rows`, of `columns` columns; nothing on error.
std::optional<std::int32_t> ChainOf(Statement rows, int columns) {
  RowChain chain;
  Statement::Result result = rows ? rows.Step() : Statement::Result::kError;
  for (; result == Statement::Result::kRow; result = rows.Step()) {
    chain.Columns(rows, 0, columns);
    chain.Link();
  }
  if (result == Statement::Result::kError) return std::nullopt;
  return chain.value();
}

}  // namespace

std::string EndText(std::size_t table, const TableEnd& end) {
  return std::string(kChainedTables[table].name) + " " + std::to_string(end.id) + " " +
         std::to_string(end.chain.value());
}

std::string EndsText(const TableEnds& ends) {
  std::string text;
  for (std::size_t i = 0; i < ends.size(); ++i) text += (i == 0 ? "" : ", ") + EndText(i, ends[i]);
  return text;
}

bool AddSceneParts(Database& database, std::int64_t number, RowChain& chain) {
  struct Part {
    const char* sql;
    int columns;
  };
  constexpr Part kParts[] = {
      {"SELECT scene, place, id, name, robot FROM body WHERE scene = ?1 ORDER BY place", 5},
      {"SELECT scene, place, id, name, type, body, p_x, p_y, p_z, q_w, q_x, q_y, q_z, sensors FROM robot"
       " WHERE scene = ?1 ORDER BY place",
       14},
      {"SELECT scene, place, id, color, x, y, z FROM target WHERE scene = ?1 ORDER BY place", 7},
  };
  for (const Part& part : kParts) {
    Statement rows = database.Prepare(part.sql);
    if (!rows) return false;
    rows.Bind(1, number);
    Statement::Result result = rows.Step();
    for (; result == Statement::Result::kRow; result = rows.Step()) chain.Columns(rows, 0, part.columns);
    if (result == Statement::Result::kError) return false;
  }
  return true;
}

bool LinkScene(Database& database, TableEnd& end) {
  const ChainedTable& table = kChainedTables[kSceneTable];
  ++end.id;
  Statement row = database.Prepare("SELECT " + std::string(table.columns) + " FROM scene WHERE id = ?1");
  if (!row) return false;
  row.Bind(1, end.id);
  if (row.Step() != Statement::Result::kRow) return false;
  end.chain.Columns(row, 0, table.column_count);
  row.Reset();
  if (!AddSceneParts(database, end.id, end.chain)) return false;
  Statement update = database.Prepare("UPDATE scene SET chain = ?1 WHERE id = ?2");
  if (!update) return false;
  update.Bind(1, std::int64_t{end.chain.Link()});
  update.Bind(2, end.id);
  return update.Run();
}

std::optional<std::int32_t> TextsChain(Database& database) {
  return ChainOf(database.Prepare("SELECT kind, name, file, content FROM text ORDER BY kind, name"), 4);
}

std::optional<std::int32_t> SealOf(Database& database) {
  return ChainOf(database.Prepare("SELECT key, value FROM meta WHERE key <> 'seal' ORDER BY key"), 2);
}

bool IsSealed(Database& database) {
  const std::optional<std::int32_t> seal = SealOf(database);
  Statement stored = database.Prepare("SELECT value FROM meta WHERE key = 'seal'");
  return seal && stored && stored.Step() == Statement::Result::kRow && stored.is_integer(0) &&
         stored.integer(0) == *seal;
}

bool Seal(Database& database) {
  const std::optional<std::int32_t> seal = SealOf(database);
  return seal && SetMeta(database, "seal", std::int64_t{*seal});
}

}  // namespace coopdyn
