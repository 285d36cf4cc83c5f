// SPDX-License-Identifier: MIT
// What is wrong with a text that is no XML, in words. Pure; any thread.
#pragma once

#include <string>
#include <string_view>

#include "server/base/diagnostics.h"

namespace coopdyn::rosiml {

/// Reports tags that do not match, attributes without quotes, entities that are not defined and the like.
void FindXmlMistakes(std::string_view text, const std::string& file, Diagnostics& diagnostics);

}  // namespace coopdyn::rosiml
