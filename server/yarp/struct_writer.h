// SPDX-License-Identifier: MIT
// Writes data that YARP programs read field by field (Thrift structs, Vectors). A Bottle of the same values
// would omit tags. Pure; one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/yarp/bottle.h"
#include "server/yarp/yarp_bytes.h"

namespace coopdyn {

class YarpStructWriter {
 public:
  /// Appends to `out`, which outlives it.
  YarpStructWriter(YarpDialect dialect, std::string& out)
      : dialect_(dialect),
        out_(out),
        double_tag_(dialect == YarpDialect::k4 ? 20 : 10),
        float_tag_(dialect == YarpDialect::k4 ? 10 : 128) {}

  /// Starts a struct; its fields follow, each with its tag.
  void Struct(std::size_t fields) { List(0, fields); }
  void Vocab(std::string_view word) { Tagged(9, VocabCode(word)); }
  /// A code without a word.
  void VocabNumber(std::int32_t code) { Tagged(9, code); }
  void Bool(bool value) { Vocab(value ? "ok" : "fail"); }
  void Int(std::int32_t value) { Tagged(1, value); }
  void Double(double value) { Tagged(double_tag_, value); }
  void String(std::string_view text) {
    Tagged(4, static_cast<std::int32_t>(text.size()));
    out_ += text;
  }
  /// A list of arbitrary values.
  void Items(const Bottle& bottle) { EncodeBottle(bottle, dialect_, out_); }
  /// A Vector, or a Thrift list.
  template <typename Range>
  void Doubles(const Range& values) {
    List(double_tag_, std::size(values));
    for (const double value : values) AppendBytes(value, out_);
  }
  template <typename Range>
  void Floats(const Range& values) {
    List(float_tag_, std::size(values));
    for (const float value : values) AppendBytes(value, out_);
  }
  template <typename Range>
  void Ints(const Range& values) {
    List(1, std::size(values));
    for (const std::int32_t value : values) AppendBytes(value, out_);
  }

 private:
  void List(std::int32_t tag, std::size_t size) {
    constexpr std::int32_t kList = 256;
    Tagged(kList | tag, static_cast<std::int32_t>(size));
  }
  template <typename Number>
  void Tagged(std::int32_t tag, Number value) {
    AppendBytes(tag, out_);
    AppendBytes(value, out_);
  }

  const YarpDialect dialect_;
  std::string& out_;
  const std::int32_t double_tag_, float_tag_;
};

}  // namespace coopdyn
