// SPDX-License-Identifier: MIT
#include "server/record/run_seal.h"

#include "server/record/run_tables.h"

namespace coopdyn {

namespace {

/// Chains all rows of `rows`, of `columns` columns.
std::int32_t ChainOf(Statement rows, int columns) {
  RowChain chain;
  while (rows.Step()) {
    chain.Columns(rows, 0, columns);
    chain.Link();
  }
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

void AddSceneParts(Database& database, std::int64_t number, RowChain& chain) {
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
    rows.Bind(1, number);
    while (rows.Step()) chain.Columns(rows, 0, part.columns);
  }
}

bool LinkScene(Database& database, TableEnd& end) try {
  const ChainedTable& table = kChainedTables[kSceneTable];
  ++end.id;
  Statement row = database.Prepare("SELECT " + std::string(table.columns) + " FROM scene WHERE id = ?1");
  row.Bind(1, end.id);
  if (!row.Step()) return false;
  end.chain.Columns(row, 0, table.column_count);
  row.Reset();
  AddSceneParts(database, end.id, end.chain);
  Statement update = database.Prepare("UPDATE scene SET chain = ?1 WHERE id = ?2");
  if (!update) return false;
  update.Bind(1, std::int64_t{end.chain.Link()});
  update.Bind(2, end.id);
  return update.Run();
} catch (const DatabaseError&) {
  return false;
}

std::int32_t TextsChain(Database& database) {
  return ChainOf(database.Prepare("SELECT kind, name, file, content FROM text ORDER BY kind, name"), 4);
}

std::int32_t SealOf(Database& database) {
  return ChainOf(database.Prepare("SELECT key, value FROM meta WHERE key <> 'seal' ORDER BY key"), 2);
}

bool IsSealed(Database& database) {
  const std::int32_t seal = SealOf(database);
  return database.Integer("SELECT value FROM meta WHERE key = 'seal' AND typeof(value) = 'integer'") == seal;
}

bool SealTexts(Database& database) try {
  return SetMeta(database, "texts", std::int64_t{TextsChain(database)});
} catch (const DatabaseError&) {
  return false;
}

bool Seal(Database& database) try {
  return SetMeta(database, "seal", std::int64_t{SealOf(database)});
} catch (const DatabaseError&) {
  return false;
}

}  // namespace coopdyn
