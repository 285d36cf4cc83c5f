// SPDX-License-Identifier: MIT
// By which description libsdformat reads a file: it copies all that it describes for each element of the
// file.
#pragma once

#include <tinyxml2.h>

#include <sdf/sdf.hh>

namespace coopdyn {

/// Of what may stand in a file like `root`: models alone, or worlds and actors, too, which take twice as
/// long.
sdf::SDFPtr WholeDescription(const tinyxml2::XMLElement& root);

/// The same without optional groups of elements that do not stand in `root`, but for those in sensors and
/// lights. It reads a right file alike, many times as fast; of a wrong one it does not know what could stand
/// there.
sdf::SDFPtr DescriptionFor(const tinyxml2::XMLElement& root);

}  // namespace coopdyn
