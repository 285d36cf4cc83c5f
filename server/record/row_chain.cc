// SPDX-License-Identifier: MIT
#define XXH_INLINE_ALL
#include "server/record/row_chain.h"

#include <xxhash.h>

#include "server/base/bytes.h"
#include "server/record/run_tables.h"

namespace coopdyn {

namespace {

/// The chain over all rows of `rows`.
std::int32_t ChainOf(Statement rows) {
  RowChain chain;
  while (rows.Step()) {
    chain.AddColumns(rows, rows.columns());
    chain.Link();
  }
  return chain.value();
}

}  // namespace

void RowChain::Restart(std::int32_t value) {
  value_ = value;
  bytes_.clear();
  ByteWriter(bytes_).Number(value);
}

void RowChain::Add(std::int64_t value) {
  ByteWriter writer(bytes_);
  writer.Word(Statement::Kind::kInteger, Statement::Kind::kBlob);
  writer.Number(value);
}

void RowChain::Add(std::string_view text) {
  Put(Statement::Kind::kText, std::as_bytes(std::span(text)));
}

void RowChain::Add(std::span<const std::byte> bytes) {
  Put(bytes.empty() ? Statement::Kind::kNull : Statement::Kind::kBlob, bytes);
}

void RowChain::Put(Statement::Kind kind, std::span<const std::byte> bytes) {
  ByteWriter writer(bytes_);
  writer.Word(kind, Statement::Kind::kBlob);
  if (kind != Statement::Kind::kNull) writer.Bytes(bytes);
}

void RowChain::AddColumns(const Statement& row, int count) {
  for (int column = 0; column < count; ++column) {
    const Statement::Kind kind = row.kind(column);
    if (kind == Statement::Kind::kInteger) {
      Add(row.integer(column));
    } else if (kind == Statement::Kind::kReal) {
      ByteWriter writer(bytes_);
      writer.Word(kind, Statement::Kind::kBlob);
      writer.Number(row.real(column));
    } else {
      Put(kind, row.blob(column));
    }
  }
}

std::int32_t RowChain::Link() {
  const std::uint64_t hash = XXH3_64bits(bytes_.data(), bytes_.size());
  Restart(static_cast<std::int32_t>(static_cast<std::uint32_t>(hash)));
  return value_;
}

std::string EndText(std::size_t table, const TableEnd& end) {
  return std::string(kChainedTables[table].name) + " " + std::to_string(end.id) + " " +
         std::to_string(end.chain.value());
}

std::string EndsText(const TableEnds& ends) {
  std::string text;
  for (std::size_t i = 0; i < ends.size(); ++i) text += (i == 0 ? "" : ", ") + EndText(i, ends[i]);
  return text;
}

void AddSceneParts(const Database& database, std::int64_t number, RowChain& chain) {
  for (const char* part :
       {"SELECT scene, place, id, name, robot FROM body",
        "SELECT scene, place, id, name, type, body, p_x, p_y, p_z, q_w, q_x, q_y, q_z, sensors FROM robot",
        "SELECT scene, place, robot, module, joint FROM channel",
        "SELECT scene, place, id, color, x, y, z FROM target"}) {
    Statement rows = database.Prepare(std::string(part) + " WHERE scene = ?1 ORDER BY place");
    rows.Bind(1, number);
    while (rows.Step()) chain.AddColumns(rows, rows.columns());
  }
}

void LinkScene(const Database& database, TableEnd& end) {
  const std::string columns = kChainedTables[kSceneTable].columns;
  Statement row = database.Prepare("SELECT " + columns + " FROM scene WHERE id = ?1");
  row.Bind(1, ++end.id);
  if (row.Step()) end.chain.AddColumns(row, row.columns());
  row.Reset();
  AddSceneParts(database, end.id, end.chain);
  database.Prepare("UPDATE scene SET chain = ?1 WHERE id = ?2").Run(end.chain.Link(), end.id);
}

std::int32_t TextsChain(const Database& database) {
  return ChainOf(database.Prepare("SELECT kind, name, file, content FROM text ORDER BY kind, name"));
}

std::int32_t SealOf(const Database& database) {
  return ChainOf(database.Prepare("SELECT key, value FROM meta WHERE key <> 'seal' ORDER BY key"));
}

bool IsSealed(const Database& database) {
  const auto seal =
      database.Integer("SELECT value FROM meta WHERE key = 'seal' AND typeof(value) = 'integer'");
  return seal == SealOf(database);
}

void Seal(const Database& database) {
  SetMeta(database, "seal", SealOf(database));
}

}  // namespace coopdyn
