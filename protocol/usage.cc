// SPDX-License-Identifier: MIT
#include "protocol/usage.h"

#include <algorithm>
#include <cmath>

#include "protocol/codec.h"

namespace coopdyn {
namespace {

std::size_t RequiredCount(std::span<const ValueSpec> values) {
  return static_cast<std::size_t>(std::find_if(values.begin(), values.end(),
                                               [](const ValueSpec& v) { return v.optional || v.repeated; }) -
                                  values.begin());
}

/// The text of an example value in a line.
std::string ExampleValue(const ValueSpec& value, bool is_param) {
  if (!value.enums.empty()) return value.enums.front().first;
  const double number = std::isfinite(value.min) ? std::max(value.min, 1.0) : 1.0;
  if (is_param) return std::to_string(static_cast<std::int32_t>(number));
  std::string text;
  AppendDouble(number, text);
  return text;
}

void AppendNames(std::span<const ValueSpec> values, bool mark_optional, std::string& out) {
  for (const ValueSpec& value : values) {
    if (!out.empty() && out.back() != '(') out += ' ';
    out += value.optional && !value.repeated && mark_optional ? "[" + value.name + "]" : value.name;
  }
  if (!values.empty() && values.back().repeated) out += " …";
}

}  // namespace

std::size_t FixedCount(std::span<const ValueSpec> values) {
  return static_cast<std::size_t>(
      std::find_if(values.begin(), values.end(), [](const ValueSpec& v) { return v.repeated; }) -
      values.begin());
}

const ValueSpec* ValueAt(std::span<const ValueSpec> values, std::size_t index) {
  const std::size_t fixed = FixedCount(values);
  if (index < fixed) return &values[index];
  if (fixed == values.size()) return nullptr;
  return &values[fixed + (index - fixed) % (values.size() - fixed)];
}

bool CountFits(std::span<const ValueSpec> values, std::size_t count) {
  if (count < RequiredCount(values)) return false;
  const std::size_t fixed = FixedCount(values);
  if (count <= fixed) return true;
  return fixed < values.size() && (count - fixed) % (values.size() - fixed) == 0;
}

bool TakesNothing(const CommandSpec& spec) {
  return spec.text == TextUse::kNone && spec.params.empty() && spec.data.empty();
}

std::span<const ValueSpec> BareParams(const CommandSpec& spec) {
  const std::span<const ValueSpec> params = spec.params;
  if (spec.text == TextUse::kRest) return params.first(0);
  return spec.data.empty() ? params : params.first(RequiredCount(params));
}

std::string Usage(const CommandSpec& spec) {
  std::string usage = spec.name;
  const std::span<const ValueSpec> bare = BareParams(spec);
  if (bare.size() < spec.params.size()) {
    usage += " [(";
    AppendNames(std::span(spec.params).subspan(bare.size()), false, usage);
    usage += ")]";
  }
  const bool text_optional = spec.text == TextUse::kFirst || spec.text_optional;
  switch (spec.text) {
    case TextUse::kNone:
      break;
    case TextUse::kRest:
    case TextUse::kFirst:
      usage += text_optional ? " [" + spec.text_name + "]" : " " + spec.text_name;
      break;
    case TextUse::kOrNumber:
      usage += " " + spec.text_name + " |";
      break;
  }
  AppendNames(bare, true, usage);
  AppendNames(spec.data, true, usage);
  return usage;
}

std::string ExampleLine(const CommandSpec& spec) {
  if (!spec.example.empty()) return spec.example;
  std::string line = spec.name;
  if (spec.text != TextUse::kNone && !spec.text_optional) line += " \"" + spec.text_name + "\"";
  if (spec.text == TextUse::kOrNumber) return line;
  for (const ValueSpec& value : std::span(spec.params).first(RequiredCount(spec.params))) {
    line += " " + ExampleValue(value, true);
  }
  for (const ValueSpec& value : spec.data) {
    if (!value.optional) line += " " + ExampleValue(value, false);
  }
  return line;
}

std::string ListOf(std::span<const ValueSpec> values) {
  constexpr std::size_t kNamed = 6;  // more are counted
  if (values.size() > kNamed && values.back().optional && !values.back().repeated) {
    return std::to_string(RequiredCount(values)) + " to " + std::to_string(values.size()) + " numbers";
  }
  std::string list;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ValueSpec& value = values[i];
    if (i > 0) list += i + 1 == values.size() ? " and " : ", ";
    list += value.name;
    if (!value.unit.empty()) list += " (" + value.unit + ")";
    const bool others_needed = !values.front().optional && !values.front().repeated;
    if (value.optional && !value.repeated && others_needed) list += " if wanted";
  }
  if (!values.empty() && values.back().repeated) list += ", any number of times";
  return list.empty() ? "nothing" : list;
}

std::string ListOfEnums(const ValueSpec& value) {
  std::string list;
  for (std::size_t i = 0; i < value.enums.size(); ++i) {
    if (i > 0) list += i + 1 == value.enums.size() ? " or " : ", ";
    list += value.enums[i].first + " (" + std::to_string(value.enums[i].second) + ")";
  }
  return list;
}

std::string Instead(const ValueSpec& value) {
  return value.instead.empty() ? "" : " (" + value.instead + ")";
}

std::string ValuesCell(std::span<const ValueSpec> values, bool words) {
  std::string cell;
  const std::size_t fixed = FixedCount(values);
  const bool group = values.size() > fixed + 1;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ValueSpec& value = values[i];
    if (i > 0) cell += ", ";
    if (group && i == fixed) cell += "(";
    std::string entry = value.name;
    if (!value.unit.empty()) entry += " " + value.unit;
    if (words && !value.enums.empty()) entry += " = " + ListOfEnums(value);
    cell += value.optional && !value.repeated ? "[" + entry + "]" : entry;
  }
  if (group) cell += ")";
  if (fixed < values.size()) cell += " …";
  return cell.empty() ? "–" : cell;
}

}  // namespace coopdyn
