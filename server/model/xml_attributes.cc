// SPDX-License-Identifier: MIT
#include "server/model/xml_attributes.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/model/values.h"

namespace coopdyn {

XmlAttributes::XmlAttributes(const tinyxml2::XMLElement& element, std::string file, Diagnostics& diagnostics)
    : element_(element), file_(std::move(file)), diagnostics_(diagnostics) {}

std::optional<std::string> XmlAttributes::Text(const std::string& name) {
  known_.push_back(name);
  const char* text = element_.Attribute(name.c_str());
  if (text == nullptr) return std::nullopt;
  return std::string(text);
}

std::optional<double> XmlAttributes::Number(const std::string& name, double min, double max) {
  const std::optional<std::string> text = Text(name);
  if (!text) return std::nullopt;
  const std::optional<double> value = ParsePlain(*text);
  if (!value || *value < min || *value > max) {
    Error("'" + name + "' must be a number from " + FormatNumber(min) + " to " + FormatNumber(max) +
          ", not '" + *text + "'");
    return std::nullopt;
  }
  return value;
}

std::optional<int> XmlAttributes::Integer(const std::string& name, int min, int max) {
  const std::optional<double> value = Number(name, min, max);
  if (!value) return std::nullopt;
  if (*value != std::floor(*value)) {
    Error("'" + name + "' must be a whole number, not " + FormatNumber(*value));
    return std::nullopt;
  }
  return static_cast<int>(*value);
}

std::optional<bool> XmlAttributes::Flag(const std::string& name) {
  const std::optional<std::string> text = Text(name);
  if (!text) return std::nullopt;
  if (*text != "true" && *text != "false") {
    Error("'" + name + "' must be true or false, not '" + *text + "'");
    return std::nullopt;
  }
  return *text == "true";
}

std::optional<std::vector<double>> XmlAttributes::Numbers(const std::string& name, std::size_t count) {
  const std::optional<std::string> text = Text(name);
  if (!text) return std::nullopt;
  std::vector<double> values;
  for (const std::string& word : SplitWords(*text)) {
    const std::optional<double> value = ParsePlain(word);
    if (value) values.push_back(*value);
    if (!value || values.size() > count) break;
  }
  if (values.size() != count || SplitWords(*text).size() != count) {
    Error("'" + name + "' must be " + std::to_string(count) + " finite numbers, not '" + *text + "'");
    return std::nullopt;
  }
  return values;
}

void XmlAttributes::Error(const std::string& text) {
  diagnostics_.Error(where(), std::string("<") + element_.Name() + ">: " + text);
}

void XmlAttributes::Require(const std::string& name) {
  if (element_.Attribute(name.c_str()) == nullptr) Error("the attribute '" + name + "' is missing");
}

void XmlAttributes::Finish() {
  for (const tinyxml2::XMLAttribute* attribute = element_.FirstAttribute(); attribute != nullptr;
       attribute = attribute->Next()) {
    if (std::find(known_.begin(), known_.end(), attribute->Name()) == known_.end()) {
      Error(std::string("unknown attribute '") + attribute->Name() + "'" +
            DidYouMean(attribute->Name(), known_));
    }
  }
}

SourceLine XmlAttributes::where() const {
  return {file_, element_.GetLineNum()};
}

}  // namespace coopdyn
