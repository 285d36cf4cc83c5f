// SPDX-License-Identifier: MIT
// Reads fields of JSON that may be anything. Pure; any thread.
#pragma once

#include <string>
#include <string_view>

#include <boost/json.hpp>

namespace coopdyn {

/// The text at `key`; empty if there is none.
inline std::string TextIn(const boost::json::object& object, std::string_view key) {
  const boost::json::value* const value = object.if_contains(key);
  return value != nullptr && value->is_string() ? std::string(value->as_string()) : std::string();
}

}  // namespace coopdyn
