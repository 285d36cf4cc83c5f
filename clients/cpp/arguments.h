// SPDX-License-Identifier: MIT
// Checks of what a caller gives, before anything is sent.
#pragma once

#include <cmath>
#include <sstream>
#include <string>

#include "clients/cpp/error.h"

namespace coopdyn::client {

/// `value`; throws Error 4 that names it if it is infinite or no number.
inline double Finite(double value, const char* what) {
  if (!std::isfinite(value)) throw Error(4, std::string(what) + " must be finite");
  return value;
}

/// `value` as a program would write it.
inline std::string Written(double value) {
  std::ostringstream out;
  out.precision(9);
  out << value;
  return out.str();
}

}  // namespace coopdyn::client
