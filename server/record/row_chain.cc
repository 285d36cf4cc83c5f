// SPDX-License-Identifier: MIT
#define XXH_INLINE_ALL
#include "server/record/row_chain.h"

#include <xxhash.h>

#include <cmath>

#include "server/record/bytes.h"

namespace coopdyn {

void RowChain::Restart(std::int32_t value) {
  value_ = value;
  bytes_.clear();
  ByteWriter(bytes_).Put(value);
}

void RowChain::Null() {
  ByteWriter(bytes_).Put(static_cast<std::uint8_t>(Statement::Kind::kNull));
}

void RowChain::Integer(std::int64_t value) {
  ByteWriter writer(bytes_);
  writer.Put(static_cast<std::uint8_t>(Statement::Kind::kInteger));
  writer.Put(value);
}

void RowChain::Text(std::string_view text) {
  Put(Statement::Kind::kText, std::as_bytes(std::span(text)));
}

void RowChain::Blob(std::span<const std::byte> bytes) {
  if (bytes.empty()) return Null();
  Put(Statement::Kind::kBlob, bytes);
}

void RowChain::Put(Statement::Kind kind, std::span<const std::byte> bytes) {
  ByteWriter writer(bytes_);
  writer.Put(static_cast<std::uint8_t>(kind));
  writer.Put(static_cast<std::uint32_t>(bytes.size()));
  writer.PutBytes(bytes);
}

void RowChain::Columns(const Statement& row, int first, int count) {
  for (int column = first; column < first + count; ++column) {
    const Statement::Kind kind = row.kind(column);
    switch (kind) {
      case Statement::Kind::kNull:
        Null();
        break;
      case Statement::Kind::kInteger:
        Integer(row.integer(column));
        break;
      case Statement::Kind::kReal: {
        ByteWriter writer(bytes_);
        writer.Put(static_cast<std::uint8_t>(kind));
        writer.Put(row.real(column));
        break;
      }
      case Statement::Kind::kText:
      case Statement::Kind::kBlob:
        Put(kind, row.blob(column));
        break;
    }
  }
}

std::int32_t RowChain::Link() {
  const std::uint64_t hash = XXH3_64bits(bytes_.data(), bytes_.size());
  Restart(static_cast<std::int32_t>(static_cast<std::uint32_t>(hash)));
  return value_;
}

}  // namespace coopdyn
