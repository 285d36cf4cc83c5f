// SPDX-License-Identifier: MIT
// The schema by which libsdformat reads a file. libsdformat copies the schema's element for each element of
// the file, so a smaller schema is faster.
#pragma once

#include <tinyxml2.h>

#include <sdf/sdf.hh>

namespace coopdyn {

/// The schema for a file like `root`: only models, or also worlds and actors, which takes twice as long.
sdf::SDFPtr WholeDescription(const tinyxml2::XMLElement& root);

/// The same without optional element groups that do not occur in `root`, except those in sensors, lights and
/// particle emitters. Reads a valid file identically but many times faster. For an invalid file it does not
/// know which elements are allowed.
sdf::SDFPtr DescriptionFor(const tinyxml2::XMLElement& root);

}  // namespace coopdyn
