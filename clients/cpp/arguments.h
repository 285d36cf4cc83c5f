// SPDX-License-Identifier: MIT
// Numbers: checks of what a caller gives, and of what the daemon says.
#pragma once

#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>

#include "clients/cpp/error.h"

namespace coopdyn::client {

/// `value`; throws Error 4 that names it if it is infinite or no number.
inline double Finite(double value, const char* what) {
  if (!std::isfinite(value)) throw Error(4, std::string(what) + " must be finite");
  return value;
}

/// `value` without its fraction, as the daemon writes whole numbers; 0 if it is none.
inline std::int64_t Whole(double value) {
  return std::abs(value) < 9e18 ? static_cast<std::int64_t>(value) : 0;
}

/// `value` as a program would write it.
inline std::string Written(double value) {
  std::ostringstream out;
  out.precision(9);
  out << value;
  return out.str();
}

}  // namespace coopdyn::client
