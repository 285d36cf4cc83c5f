// SPDX-License-Identifier: MIT
// For sources written for YARS: a motor or a sensor of one or several values.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "yars/types/Domain.h"

struct NameDimensionDomain {
  std::string name;
  int dimension = 0;
  std::vector<Domain> internal, external;  // one per value
  std::vector<std::string> names;          // one per value

  explicit NameDimensionDomain(std::string of = "", int values = 0)
      : name(std::move(of)), dimension(values) {}
};
