// SPDX-License-Identifier: MIT
#include "server/replay/mat_value.h"

#include <algorithm>
#include <new>
#include <utility>

namespace coopdyn {

namespace {

/// UTF-16 code units, as MATLAB stores text; empty if `text` is not UTF-8.
std::vector<std::uint16_t> ToUtf16(const std::string& text) {
  std::vector<std::uint16_t> units;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xC2 ? 0
                               : lead < 0xE0 ? 2
                               : lead < 0xF0 ? 3
                               : lead < 0xF5 ? 4
                                             : 0;
    if (length == 0 || i + length > text.size()) return {};
    std::uint32_t code = length == 1 ? lead : lead & (0x7FU >> length);
    for (std::size_t k = 1; k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      if ((next & 0xC0U) != 0x80U) return {};
      code = code << 6U | (next & 0x3FU);
    }
    i += length;
    if (code < 0x10000) {
      units.push_back(static_cast<std::uint16_t>(code));
    } else {
      code -= 0x10000;
      units.push_back(static_cast<std::uint16_t>(0xD800 + (code >> 10U)));
      units.push_back(static_cast<std::uint16_t>(0xDC00 + (code & 0x3FFU)));
    }
  }
  return units;
}

MatValue Make(matio_classes class_type, matio_types type, std::size_t rows, std::size_t columns, void* data,
              int options = 0) {
  std::size_t dims[2] = {rows, columns};
  MatValue value(Mat_VarCreate(nullptr, class_type, type, 2, dims, data, options));
  if (value == nullptr) throw std::bad_alloc();
  return value;
}

}  // namespace

MatMatrix::MatMatrix(std::size_t columns, std::size_t max_rows) : columns_(columns) {
  SetRoom(max_rows);
}

void MatMatrix::SetRoom(std::size_t room) {
  if (room < room_) {  // moves columns left in order: none is overwritten before it has moved
    for (std::size_t c = 1; c < columns_; ++c) {
      const double* from = data_.data() + c * room_;
      std::copy(from, from + rows_, data_.data() + c * room);
    }
    data_.resize(columns_ * room);
  } else if (room > room_) {
    std::vector<double> larger(columns_ * room);
    for (std::size_t c = 0; c < columns_; ++c) {
      const double* from = data_.data() + c * room_;
      std::copy(from, from + rows_, larger.data() + c * room);
    }
    data_ = std::move(larger);
  }
  room_ = room;
}

void MatMatrix::Append(std::span<const double> row) {
  if (rows_ == room_) SetRoom(2 * room_ + 16);
  for (std::size_t c = 0; c < columns_; ++c) data_[c * room_ + rows_] = row[c];
  ++rows_;
}

MatValue MatMatrix::View() {
  SetRoom(rows_);
  return Make(MAT_C_DOUBLE, MAT_T_DOUBLE, rows_, columns_, data_.data(), MAT_F_DONT_COPY_DATA);
}

std::uint64_t MatBytes(const matvar_t& value) {
  constexpr std::uint64_t kAround = 96;     // tags, flags, dimensions, padding
  constexpr std::uint64_t kFieldName = 64;  // at most
  const bool holds_values = value.class_type == MAT_C_STRUCT || value.class_type == MAT_C_CELL;
  if (!holds_values) return kAround + value.nbytes * (value.class_type == MAT_C_CHAR ? 2 : 1);
  std::uint64_t bytes = kAround;
  std::size_t count = value.dims[0] * value.dims[1];
  if (value.class_type == MAT_C_STRUCT) {
    const unsigned fields = Mat_VarGetNumberOfFields(const_cast<matvar_t*>(&value));  // does not change it
    bytes += fields * kFieldName;
    count *= fields;
  }
  const auto* values = static_cast<const matvar_t* const*>(value.data);
  for (std::size_t i = 0; values != nullptr && i < count; ++i) {
    if (values[i] != nullptr) bytes += MatBytes(*values[i]);
  }
  return bytes;
}

MatValue MatNumber(double number) {
  return Make(MAT_C_DOUBLE, MAT_T_DOUBLE, 1, 1, &number);
}

MatValue MatNumber(std::uint64_t number) {
  return Make(MAT_C_UINT64, MAT_T_UINT64, 1, 1, &number);
}

MatValue MatText(const std::string& text) {
  std::string bytes = text;
  if (text.empty()) return Make(MAT_C_CHAR, MAT_T_UTF8, 0, 0, bytes.data());
  const bool is_ascii =
      std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  if (is_ascii) return Make(MAT_C_CHAR, MAT_T_UTF8, 1, bytes.size(), bytes.data());
  std::vector<std::uint16_t> units = ToUtf16(text);
  if (units.empty()) {
    for (const char c : text) units.push_back(static_cast<unsigned char>(c));
  }
  return Make(MAT_C_CHAR, MAT_T_UINT16, 1, units.size(), units.data());
}

MatValue MatLines(std::span<const std::string> lines) {
  const std::size_t length = lines.empty() ? 0 : lines.front().size();
  std::string by_column;
  by_column.reserve(lines.size() * length);
  for (std::size_t c = 0; c < length; ++c) {
    for (const std::string& line : lines) by_column += line[c];
  }
  return Make(MAT_C_CHAR, MAT_T_UTF8, lines.size(), length, by_column.data());
}

MatValue MatCell(std::span<const std::string> texts) {
  MatValue cell = Make(MAT_C_CELL, MAT_T_CELL, 1, texts.size(), nullptr);
  for (std::size_t i = 0; i < texts.size(); ++i)
    Mat_VarSetCell(cell.get(), static_cast<int>(i), MatText(texts[i]).release());
  return cell;
}

MatStruct::MatStruct(const char* name, std::size_t count, std::span<const char* const> fields) {
  std::vector<const char*> ended(fields.begin(), fields.end());
  ended.push_back(nullptr);
  const std::size_t dims[2] = {1, count};
  value_.reset(Mat_VarCreateStruct2(name, 2, dims, ended.data()));
  if (value_ == nullptr) throw std::bad_alloc();
}

void MatStruct::Set(const char* field, MatValue value, std::size_t index) {
  Mat_VarSetStructFieldByName(value_.get(), field, index, value.release());
}

}  // namespace coopdyn
