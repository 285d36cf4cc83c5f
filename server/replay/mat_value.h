// SPDX-License-Identifier: MIT
// Values of a MAT file, owned until they are written or moved into another value. One thread.
#pragma once

#include <matio.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace coopdyn {

struct MatFree {
  void operator()(matvar_t* value) const { Mat_VarFree(value); }
};
using MatValue = std::unique_ptr<matvar_t, MatFree>;

/// A matrix filled row by row and stored column by column, like MAT files.
class MatMatrix {
 public:
  MatMatrix() = default;
  /// Reserves room for `max_rows`; grows beyond.
  MatMatrix(std::size_t columns, std::size_t max_rows);

  /// @pre row.size() == columns
  void Append(std::span<const double> row);
  std::size_t rows() const { return rows_; }
  /// The matrix as a value that references its numbers: the matrix must outlive the value.
  MatValue View();

 private:
  void SetRoom(std::size_t room);

  std::size_t columns_ = 0, room_ = 0, rows_ = 0;
  std::vector<double> data_;
};

/// An upper bound of the bytes in a file for `value` and its contents, uncompressed.
std::uint64_t MatBytes(const matvar_t& value);

MatValue MatNumber(double number);
MatValue MatNumber(std::uint64_t number);  // class uint64
/// UTF-8 as a row of characters, '' if empty. Text that is not UTF-8 is read as Latin-1.
MatValue MatText(const std::string& text);
/// Lines of equal length (ASCII) as rows of a character matrix.
MatValue MatLines(std::span<const std::string> lines);
/// A 1 × n cell of texts.
MatValue MatCell(std::span<const std::string> texts);

/// A 1 × n struct array.
class MatStruct {
 public:
  MatStruct(const char* name, std::size_t count, std::span<const char* const> fields);
  void Set(const char* field, MatValue value, std::size_t index = 0);
  MatValue Take() { return std::move(value_); }

 private:
  MatValue value_;
};

}  // namespace coopdyn
