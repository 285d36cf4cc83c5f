// SPDX-License-Identifier: MIT
// Explains why a text is not well-formed XML. Pure; any thread.
#pragma once

#include <string>
#include <string_view>

#include "server/base/diagnostics.h"

namespace coopdyn::rosiml {

/// Reports mismatched tags, unquoted attributes, undefined entities and the like.
void FindXmlMistakes(std::string_view text, const std::string& file, Diagnostics& diagnostics);

}  // namespace coopdyn::rosiml
