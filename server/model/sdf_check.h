// SPDX-License-Identifier: MIT
// What libsdformat lets pass: unknown and unused elements, words where numbers belong. Found in the raw XML,
// with lines.
#pragma once

#include <cstddef>
#include <sdf/Element.hh>
#include <string>
#include <string_view>

#include "server/base/diagnostics.h"

namespace tinyxml2 {
class XMLElement;
}

namespace coopdyn {

/// More than any robot has; what libsdformat takes for a model grows with the square of some of them.
inline constexpr std::size_t kMaxModelBytes = 4u << 20;
inline constexpr int kMaxModelParts = 300;  // of each kind: links, joints, frames
inline constexpr int kMaxModelElements = 10'000;
inline constexpr int kMaxElementAttributes = 64;

/// False, and reported, if the `text` of a model is longer than one can be. Before it is parsed.
bool IsModelSize(std::string_view text, const std::string& file, Diagnostics& diagnostics);
/// False, and reported, if there is more of something below `root` than one robot has.
bool IsModelCount(const tinyxml2::XMLElement& root, const std::string& file, Diagnostics& diagnostics);

/// Compares the elements below `root` (`<sdf>`) with SDF's own description in `description`. Errors: unknown
/// elements and attributes, missing required attributes, unreadable or non-finite values, shapes that we
/// cannot simulate. Warnings: what SDF knows and coopdyn does not use. Elements of other namespaces are left
/// to their owners.
void CheckSdf(const tinyxml2::XMLElement& root, const sdf::ElementPtr& description, const std::string& file,
              Diagnostics& diagnostics);

}  // namespace coopdyn
