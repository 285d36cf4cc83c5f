// SPDX-License-Identifier: MIT
// Under run_file.h: opens a recording and runs queries on it (throws Error; one thread); numbers, poses and
// names out of the bytes of a recording (docs/formats.md; pure).
#pragma once

#include <sqlite3.h>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

namespace coopdyn::client {

class RunDatabase;

/// The row that a query is at.
class RunRow {
 public:
  RunRow(sqlite3_stmt* statement, const RunDatabase& database) : statement_(statement), database_(database) {}
  /// Throws Error 7 if it is no whole number.
  std::int64_t integer(int column) const;
  /// A whole number from 0 to 2^31. Throws Error 7 if it is none.
  std::int64_t count(int column) const;
  /// Throws Error 7 if it is no finite number.
  double number(int column) const;
  std::string text(int column) const;
  bool is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
  /// Until the next row. Throws Error 7 if it is neither bytes nor NULL.
  std::span<const unsigned char> bytes(int column) const;

 private:
  sqlite3_stmt* statement_;
  const RunDatabase& database_;
};

class RunDatabase {
 public:
  /// Checks what the file is.
  explicit RunDatabase(const std::string& file);

  const std::string& file() const { return file_; }
  /// Calls `use` with each row. `text`, if not null, is what ?1 stands for.
  void ForEach(const std::string& sql, const std::function<void(const RunRow&)>& use,
               const std::string* text = nullptr) const;
  /// The error of a file that does not add up.
  [[noreturn]] void Damaged(const std::string& why) const;

 private:
  int Open(bool immutable);
  std::int64_t Pragma(const char* name) const;

  std::string file_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_{nullptr, sqlite3_close_v2};
};

using Bytes = std::span<const unsigned char>;

/// The lowest byte is the first. @pre at most 8 bytes
std::uint64_t Little(Bytes bytes);
/// The lowest `width` bits as two's complement.
std::int64_t Signed(std::uint64_t bits, int width);
/// @pre 4 bytes
double Single(Bytes bytes);
/// @pre 8 bytes
double Double(Bytes bytes);

using Pose7 = std::array<double, 7>;  // x y z [m], quaternion w x y z

/// The pose of a body out of its 18 bytes (server/state/pose_codec.h), positions in units of 2^exponent µm.
Pose7 BodyPose(Bytes raw, int exponent);
/// The pose of a robot's frame R, from that of its body B, X_WB, and of R in B.
Pose7 RobotPose(const Pose7& X_WB, const Pose7& X_BR);

/// The loaded controller of a robot, in the description of a scene; empty: none.
std::string ControllerIn(Bytes scene, std::int64_t id, const std::string& name, const std::string& type);

}  // namespace coopdyn::client
