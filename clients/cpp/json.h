// SPDX-License-Identifier: MIT
// JSON replies of get_status and describe. Parsed by Boost.JSON, whose headers programs do not need. A value
// type; any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace boost::json {
class value;
}

namespace coopdyn::client {

/// A JSON value. Missing elements read as null, and null reads as 0, "" and an empty list, so that
/// `status["robots"][0]["name"].text()` needs no checks.
class Json {
 public:
  enum class Kind { kNull, kBool, kNumber, kText, kList, kObject };

  Json() = default;
  /// Parses all of `text`. Throws Error 7 if it is not JSON.
  static Json Parse(std::string_view text);

  Kind kind() const { return kind_; }
  bool is_null() const { return kind_ == Kind::kNull; }
  bool boolean() const { return kind_ == Kind::kBool && number_ != 0; }
  double number() const { return number_; }
  const std::string& text() const { return text_; }
  std::size_t size() const { return items_.size(); }
  /// Elements of a list, or the values of an object.
  const std::vector<Json>& items() const { return items_; }
  const std::vector<std::string>& keys() const { return keys_; }
  const Json& operator[](std::size_t index) const;
  const Json& operator[](std::string_view key) const;

 private:
  explicit Json(const boost::json::value& value);

  Kind kind_ = Kind::kNull;
  double number_ = 0;
  std::string text_;
  std::vector<Json> items_;
  std::vector<std::string> keys_;  // of an object, beside items_
};

}  // namespace coopdyn::client
