// SPDX-License-Identifier: MIT
// Implementation of run_file.h: opens a recording and runs queries on it (throws Error; one thread), and
// decodes numbers, poses and names from its bytes (docs/formats.md; pure).
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

/// The current row of a query.
class RunRow {
 public:
  RunRow(sqlite3_stmt* statement, const RunDatabase& database) : statement_(statement), database_(database) {}
  /// Throws Error 7 if the column is not an integer.
  std::int64_t integer(int column) const;
  /// An integer from 0 to 2^31. Throws Error 7 otherwise.
  std::int64_t count(int column) const;
  /// Throws Error 7 if the column is not a finite number.
  double number(int column) const;
  std::string text(int column) const;
  bool is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
  /// Valid until the next row. Throws Error 7 if the column is neither a blob nor NULL.
  std::span<const unsigned char> bytes(int column) const;

 private:
  sqlite3_stmt* statement_;
  const RunDatabase& database_;
};

class RunDatabase {
 public:
  /// Opens `file` and checks its format.
  explicit RunDatabase(const std::string& file);

  const std::string& file() const { return file_; }
  /// Calls `use` with each row. `text`, if not null, is bound to ?1.
  void ForEach(const std::string& sql, const std::function<void(const RunRow&)>& use,
               const std::string* text = nullptr) const;
  /// Throws the error of an inconsistent file.
  [[noreturn]] void Damaged(const std::string& why) const;

 private:
  int Open(bool immutable);
  std::int64_t Pragma(const char* name) const;

  std::string file_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_{nullptr, sqlite3_close_v2};
};

using Bytes = std::span<const unsigned char>;

/// Decodes little-endian bytes. @pre at most 8 bytes
std::uint64_t Little(Bytes bytes);
/// The lowest `width` bits as two's complement.
std::int64_t Signed(std::uint64_t bits, int width);
/// @pre 4 bytes
double Single(Bytes bytes);
/// @pre 8 bytes
double Double(Bytes bytes);

using Pose7 = std::array<double, 7>;  // x y z [m], quaternion w x y z

/// Decodes a body's pose from its 18 bytes (server/state/pose_codec.h), positions in units of 2^exponent µm.
Pose7 BodyPose(Bytes raw, int exponent);
/// The pose of a robot's frame R in the world, from the pose of its body B and the pose of R in B.
Pose7 RobotPose(const Pose7& X_WB, const Pose7& X_BR);

/// The name of a robot's loaded controller, from the description of a scene; empty: none.
std::string ControllerIn(Bytes scene, std::int64_t id, const std::string& name, const std::string& type);

}  // namespace coopdyn::client
