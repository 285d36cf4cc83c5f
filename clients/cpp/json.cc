// SPDX-License-Identifier: MIT
#include "clients/cpp/json.h"

#include <boost/json.hpp>

#include "clients/cpp/error.h"

namespace coopdyn::client {

Json Json::Parse(std::string_view text) {
  boost::system::error_code failed;
  const boost::json::value value = boost::json::parse({text.data(), text.size()}, failed);
  if (failed) throw Error(7, "the text is not JSON: " + failed.message());
  return Json(value);
}

Json::Json(const boost::json::value& value) {
  if (const bool* truth = value.if_bool()) {
    kind_ = Kind::kBool;
    number_ = *truth ? 1 : 0;
  } else if (value.is_number()) {
    kind_ = Kind::kNumber;
    number_ = value.to_number<double>();
  } else if (const boost::json::string* text = value.if_string()) {
    kind_ = Kind::kText;
    text_.assign(text->begin(), text->end());
  } else if (const boost::json::array* list = value.if_array()) {
    kind_ = Kind::kList;
    for (const boost::json::value& item : *list) items_.push_back(Json(item));
  } else if (const boost::json::object* object = value.if_object()) {
    kind_ = Kind::kObject;
    for (const auto& member : *object) {
      keys_.emplace_back(member.key());
      items_.push_back(Json(member.value()));
    }
  }
}

const Json& Json::operator[](std::size_t index) const {
  static const Json nothing;
  return index < items_.size() ? items_[index] : nothing;
}

const Json& Json::operator[](std::string_view key) const {
  static const Json nothing;
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (keys_[i] == key) return items_[i];
  }
  return nothing;
}

}  // namespace coopdyn::client
