// SPDX-License-Identifier: MIT
#include "server/app/number_checks.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "server/model/values.h"

namespace coopdyn {

namespace {

CLI::Validator Check(double least, bool least_too, double most) {
  const auto check = [=](const std::string& text) -> std::string {
    double value = 0;
    if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value)) {
      return "must be a finite number, not " + text;
    }
    if (value < least) return "must be at least " + FormatNumber(least) + ", not " + text;
    if (value == least && !least_too) return "must be above " + FormatNumber(least) + ", not " + text;
    if (value > most) return "must be at most " + FormatNumber(most) + ", not " + text;
    return {};
  };
  const char bracket = least_too ? '[' : '(';
  return {check, fmt::format("FLOAT in {}{} - {}]", bracket, FormatNumber(least), FormatNumber(most))};
}

}  // namespace

CLI::Validator NumberIn(double least, double most) {
  return Check(least, true, most);
}

CLI::Validator NumberAbove0(double most) {
  return Check(0, false, most);
}

}  // namespace coopdyn
