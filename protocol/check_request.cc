// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/codec.h"
#include "protocol/command_table.h"
#include "protocol/usage.h"

namespace coopdyn {
namespace {

CheckResult Refuse(const CommandSpec& spec, Error error, std::string why) {
  return {static_cast<std::int32_t>(error), spec.name + " " + std::move(why) + ": " + ExampleLine(spec)};
}

/// `value` as a user would write it.
std::string Written(double value) {
  std::string number;
  AppendDouble(value, number);
  if (number.ends_with(".0")) number.resize(number.size() - 2);
  return number;
}

/// Why `spec` rejects `value`; empty if it accepts the value.
std::string Objection(const ValueSpec& spec, double value) {
  if (!std::isfinite(value)) {
    return spec.any_number ? "" : "takes finite numbers, " + spec.name + " is " + Written(value);
  }
  if (value < spec.min || value > spec.max) {
    const std::string most = std::to_string(std::llround(spec.max));
    return "needs " + spec.name + " " +
           (std::isinf(spec.max)   ? "at least " + Written(spec.min)
            : std::isinf(spec.min) ? "at most " + most
                                   : "from " + Written(spec.min) + " to " + most) +
           ", not " + Written(value);
  }
  if (spec.enums.empty()) return "";
  const bool listed = std::any_of(spec.enums.begin(), spec.enums.end(),
                                  [value](const auto& word) { return word.second == value; });
  return listed
             ? ""
             : "needs a " + spec.name + ": " + ListOfEnums(spec) + ", not " + Written(value) + Instead(spec);
}

CheckResult CheckText(const CommandSpec& spec, std::string_view text, std::size_t params) {
  switch (spec.text) {
    case TextUse::kNone:
      if (!text.empty()) return Refuse(spec, Error::kWrongParams, "takes no text");
      break;
    case TextUse::kRest:
      if (text.empty() && !spec.text_optional) {
        return Refuse(spec, Error::kWrongParams, "takes a text, " + spec.text_name);
      }
      break;
    case TextUse::kOrNumber:
      if (!text.empty() && params > 0) {
        return Refuse(
            spec, Error::kWrongParams,
            "takes either the text " + spec.text_name + " or " + ListOf(spec.params) + ", not both");
      }
      if (text.empty() && !CountFits(spec.params, params)) {
        return Refuse(spec, Error::kWrongParams,
                      "takes the text " + spec.text_name + " or the param " + ListOf(spec.params));
      }
      break;
    case TextUse::kFirst:
      break;
  }
  return {};
}

CheckResult CheckCounts(const CommandSpec& spec, std::string_view text, std::size_t params,
                        std::size_t data) {
  const bool text_instead = spec.text == TextUse::kOrNumber && !text.empty();
  if (!text_instead && !CountFits(spec.params, params)) {
    if (TakesNothing(spec)) return Refuse(spec, Error::kWrongParams, "takes no values");
    if (spec.params.empty()) return Refuse(spec, Error::kWrongParams, "takes no params");
    const bool brackets = BareParams(spec).size() < spec.params.size();
    const std::string noun = spec.params.size() == 1 ? "the param " : "the params ";
    return Refuse(spec, Error::kWrongParams,
                  (CountFits(spec.params, 0) ? "takes at most " : "takes ") + noun + ListOf(spec.params) +
                      (!brackets                     ? ""
                       : spec.text == TextUse::kRest ? ", in brackets before the text"
                                                     : ", in brackets before the data"));
  }
  if (!CountFits(spec.data, data)) {
    if (TakesNothing(spec)) return Refuse(spec, Error::kWrongData, "takes no values");
    if (spec.data.empty()) return Refuse(spec, Error::kWrongData, "takes no data");
    return Refuse(spec, Error::kWrongData, "takes " + ListOf(spec.data));
  }
  return {};
}

/// @pre CountFits()
template <typename Number>
CheckResult CheckValues(const CommandSpec& spec, std::span<const ValueSpec> values,
                        std::span<const Number> numbers) {
  std::size_t at = 0;  // in `values`; a repeating group begins again at `first`
  const std::size_t first = FixedCount(values);
  for (const Number number : numbers) {
    const ValueSpec& value = values[at];
    const auto plain = static_cast<double>(number);
    if (!std::isfinite(plain) || plain < value.min || plain > value.max || !value.enums.empty()) {
      std::string objection = Objection(value, plain);
      if (!objection.empty()) return Refuse(spec, Error::kOutOfRange, std::move(objection));
    }
    if (++at == values.size()) at = first;
  }
  return {};
}

}  // namespace

CheckResult CheckRequest(const CommandSpec& spec, std::string_view text, std::span<const std::int32_t> params,
                         std::span<const double> data) {
  CheckResult result = CheckText(spec, text, params.size());
  if (result.error == 0) result = CheckCounts(spec, text, params.size(), data.size());
  if (result.error != 0) return result;
  result = CheckValues(spec, spec.params, params);
  if (result.error == 0) result = CheckValues(spec, spec.data, data);
  return result;
}

}  // namespace coopdyn
