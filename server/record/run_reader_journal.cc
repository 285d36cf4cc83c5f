// SPDX-License-Identifier: MIT
#include "server/record/run_reader_journal.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "server/record/run_header.h"
#include "server/record/run_reader_open.h"
#include "server/record/sqlite_db.h"

namespace coopdyn {

namespace {

using namespace std::string_view_literals;

constexpr std::string_view kDatabaseMagic = "SQLite format 3\0"sv;
constexpr std::size_t kApplicationIdAt = 68;  // big-endian
constexpr std::string_view kJournalMagic = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7"sv;

/// The first bytes of `file`, or the last ones; all zero if there are not as many.
template <std::size_t kSize>
std::array<char, kSize> Bytes(const std::string& file, std::ios::seekdir from) {
  std::array<char, kSize> bytes{};
  std::ifstream in(file, std::ios::binary);
  in.seekg(from == std::ios::beg ? 0 : -static_cast<std::streamoff>(kSize), from);
  if (!in.read(bytes.data(), kSize)) bytes.fill(0);
  return bytes;
}

/// A journal ends with the magic if it names a file that belongs to several databases, and that SQLite may
/// delete: no recorder makes one.
bool IsOfRecorder(const std::string& journal) {
  const auto end = Bytes<kJournalMagic.size()>(journal, std::ios::end);
  return std::string_view(end.data(), end.size()) != kJournalMagic;
}

}  // namespace

bool BeginsAsRecording(const std::string& file) {
  const auto head = Bytes<kApplicationIdAt + 4>(file, std::ios::beg);
  std::uint32_t id = 0;
  for (std::size_t i = kApplicationIdAt; i < head.size(); ++i) {
    id = id << 8 | static_cast<unsigned char>(head[i]);
  }
  return std::string_view(head.data(), head.size()).starts_with(kDatabaseMagic) && id == kRunApplicationId;
}

bool RollBack(const std::string& file) {
  const std::string journal = UnmergedLog(file);
  if (!journal.ends_with("-journal") || !IsOfRecorder(journal) || !BeginsAsRecording(file)) return false;
  std::string ignored;
  const auto database = Database::Open(file, Database::Access::kReadWrite, ignored);
  if (database == nullptr) return false;
  database->Run("PRAGMA schema_version");  // any look at the file does it
  std::error_code code;
  return !std::filesystem::exists(journal, code) && !code;
}

}  // namespace coopdyn
