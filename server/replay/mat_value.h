// SPDX-License-Identifier: MIT
// Values of a MAT file, owned until they are written or put into another. One thread.
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

/// A matrix that is filled row by row and kept column by column, as MAT files have it.
class MatMatrix {
 public:
  MatMatrix() = default;
  /// Room for `max_rows`; more make it grow.
  MatMatrix(std::size_t columns, std::size_t max_rows);

  /// @pre row.size() == columns
  void Append(std::span<const double> row);
  std::size_t rows() const { return rows_; }
  /// The matrix as a value that holds its numbers by reference: this must outlive it.
  MatValue View();

 private:
  void SetRoom(std::size_t room);

  std::size_t columns_ = 0, room_ = 0, rows_ = 0;
  std::vector<double> data_;
};

/// No more bytes than this are in a file for `value` and all that is in it, not compressed.
std::uint64_t MatBytes(const matvar_t& value);

MatValue MatNumber(double number);
MatValue MatNumber(std::uint64_t number);  // class uint64
/// UTF-8 as a row of characters, '' if empty. What is not UTF-8 is taken as Latin-1.
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
