// SPDX-License-Identifier: MIT
// For sources written for YARS: the range of a value.
#pragma once

#include <algorithm>

#include "yars/defines/types.h"

struct Domain {
  double min = 0, max = 0;

  Domain() = default;
  Domain(double least, double most) : min(least), max(most) {}

  double width() const { return max < min ? min - max : max - min; }
  double cut(double value) const { return std::min(std::max(value, std::min(min, max)), std::max(min, max)); }
  /// Maps the range to 0…1, and back.
  double map(double value) const { return (cut(value) - min) / (max - min); }
  double remap(double value) const { return cut(min + value * (max - min)); }
};
