// SPDX-License-Identifier: MIT
// The colour words of files. Pure functions; any thread.
#pragma once

#include <string>
#include <vector>

#include "server/model/world_model.h"

namespace coopdyn {

/// All colour words, in the order of the table in docs/formats.md.
const std::vector<std::string>& ColorNames();

/// The word for `color_n` of a [TARGET], n ≥ 1: red, green, blue, …, then again from the start.
const std::string& PaletteName(int n);

}  // namespace coopdyn
