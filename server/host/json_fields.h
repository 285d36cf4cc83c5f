// SPDX-License-Identifier: MIT
// Reads fields of JSON that may be anything. Pure; any thread.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <boost/json.hpp>

namespace coopdyn {

/// The text at `key`; empty if there is none.
inline std::string TextIn(const boost::json::object& object, std::string_view key) {
  const boost::json::value* const value = object.if_contains(key);
  return value != nullptr && value->is_string() ? std::string(value->as_string()) : std::string();
}

/// The object that `text` is; empty: it is none.
inline boost::json::object ObjectIn(std::string_view text) {
  boost::system::error_code failed;
  boost::json::value read = boost::json::parse(text, failed);
  return failed || !read.is_object() ? boost::json::object() : std::move(read.as_object());
}

}  // namespace coopdyn
