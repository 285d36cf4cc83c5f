// SPDX-License-Identifier: MIT
// What libsdformat lets pass: unknown and unused elements, words where numbers belong. Found in the raw XML,
// with lines.
#pragma once

#include <sdf/Element.hh>
#include <string>

#include "server/base/diagnostics.h"

namespace tinyxml2 {
class XMLElement;
}

namespace coopdyn {

/// Compares the elements below `root` (`<sdf>`) with SDF's own description in `description`. Errors: unknown
/// elements and attributes, missing required attributes, unreadable or non-finite values, shapes that we
/// cannot simulate. Warnings: what SDF knows and coopdyn does not use. Elements of other namespaces are left
/// to their owners.
void CheckSdf(const tinyxml2::XMLElement& root, const sdf::ElementPtr& description, const std::string& file,
              Diagnostics& diagnostics);

}  // namespace coopdyn
