// SPDX-License-Identifier: MIT
// Compares a valid recording with a damaged copy of it, and repeats the copy. Every five bytes are one damage
// to a row: the row is deleted, or one of its values is changed. Nothing may crash or hang; the report names
// the differences or the reason why the comparison is impossible.

// link: coopdyn_replay coopdyn_record coopdyn_state coopdyn_source_dir PkgConfig::SQLITE3

#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "server/replay/verify.h"
#include "tests/source_dir.h"

namespace {

using coopdyn::RunReader;

void Require(bool fine) {
  if (!fine) std::abort();
}

struct Column {
  std::string table, name;
};

class Copy {
 public:
  Copy() : sound_(coopdyn::SourceDir() + "/tests/fuzz/run_file_corpus/one_robot") {
    const char* folder = std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp";
    file_ = std::string(folder) + "/coopdyn_compare_" + std::to_string(::getpid()) + ".run";
    Renew();
    sqlite3* const database = Open();
    const auto add = [](void* columns, int, char** values, char**) {
      static_cast<std::vector<Column>*>(columns)->push_back({values[0], values[1]});
      return 0;
    };
    const char* const all =
        "SELECT m.name, c.name FROM sqlite_master m, pragma_table_info(m.name) c WHERE m.type = 'table'";
    Require(sqlite3_exec(database, all, add, &columns_, nullptr) == SQLITE_OK && !columns_.empty());
    sqlite3_close(database);
  }
  ~Copy() { Remove(); }

  const std::string& sound() const { return sound_; }
  const std::string& file() const { return file_; }

  void Damage(std::span<const std::uint8_t> bytes) {
    Renew();
    sqlite3* const database = Open();
    for (; bytes.size() >= 5; bytes = bytes.subspan(5)) {
      const Column& column = columns_[bytes[0] % columns_.size()];
      const std::string value = ValueOf(column, bytes[1], static_cast<std::int8_t>(bytes[2]));
      // The row by its index, because not every table has row numbers.
      const std::string row = " WHERE (SELECT count(*) FROM " + column.table + ") > 0 AND " + column.name +
                              " IS (SELECT " + column.name + " FROM " + column.table + " LIMIT 1 OFFSET " +
                              std::to_string(bytes[3] % 32) + ")";
      const bool goes = bytes[4] % 4 == 0;
      const std::string change =
          goes ? "DELETE FROM " + column.table + row
               : "UPDATE OR IGNORE " + column.table + " SET " + column.name + " = " + value + row;
      sqlite3_exec(database, change.c_str(), nullptr, nullptr, nullptr);
    }
    sqlite3_close(database);
  }

 private:
  static std::string ValueOf(const Column& column, std::uint8_t kind, int number) {
    const std::string n = std::to_string(number),
                      from_other = " FROM " + column.table + " LIMIT 1 OFFSET " + n + ")";
    switch (kind % 8) {
      case 0:
        return n;
      case 1:
        return column.name + " + " + n;
      case 2:
        return "NULL";
      case 3:
        return "9223372036854775807 - abs(" + n + ")";
      case 4:
        return "x''";
      case 5:
        return "substr(" + column.name + ", 1, abs(" + n + "))";
      case 6:
        return "CAST(substr(" + column.name + ", 1, abs(" + n + ")) || char(" + std::to_string(kind) +
               ") || substr(" + column.name + ", abs(" + n + ") + 2) AS " + (kind < 128 ? "BLOB)" : "TEXT)");
      default:
        return "(SELECT " + column.name + from_other;
    }
  }

  sqlite3* Open() const {
    sqlite3* database = nullptr;
    Require(sqlite3_open(file_.c_str(), &database) == SQLITE_OK);
    sqlite3_exec(database, "PRAGMA synchronous = OFF; PRAGMA journal_mode = MEMORY", nullptr, nullptr,
                 nullptr);
    return database;
  }
  void Renew() const {
    Remove();
    std::filesystem::copy_file(sound_, file_);
  }
  void Remove() const {
    for (const char* end : {"", "-wal", "-shm", "-journal"}) ::unlink((file_ + end).c_str());
  }

  const std::string sound_;
  std::string file_;
  std::vector<Column> columns_;
};

void Look(const std::string& one, const std::string& other) {
  static const coopdyn::SteadyClock clock;
  static const coopdyn::Logger logger = coopdyn::NullLogger();
  static coopdyn::WorkerPool pool(1);
  static const coopdyn::ReplayServices services{clock, logger, pool, {}, {}};
  const auto ignore = [](double) {};
  std::string error;
  const auto first = RunReader::Open(one, error);
  if (first == nullptr) return Require(!error.empty());
  const auto second = RunReader::Open(other, error);
  if (second == nullptr) return Require(!error.empty());
  Require(!coopdyn::ToString(coopdyn::Compare(*first, *second, services, ignore)).empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Copy copy;
  copy.Damage({data, std::min<std::size_t>(size, 100)});
  Look(copy.sound(), copy.file());
  Look(copy.file(), copy.sound());
  return 0;
}
