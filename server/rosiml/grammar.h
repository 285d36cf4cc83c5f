// SPDX-License-Identifier: MIT
// Checks an experiment against its grammar. Pure; any thread.
#pragma once

#include <string>

#include "server/base/diagnostics.h"
#include "server/rosiml/xml.h"

namespace coopdyn::rosiml {

/// RoSiML as in the YARS paper (<movables>), or the grammar 0.8 of the public YARS (<robots>).
enum class Dialect { kPaper, kPublic };
Dialect DialectOf(const Element& root);

/// Reports unknown, missing and duplicate elements and attributes, and invalid values. Warns once per kind
/// about parts that coopdyn does not simulate yet. Renames elements that look misspelt, so that the reader
/// reports no further errors about them.
void CheckGrammar(Element& root, Dialect dialect, const std::string& file, Diagnostics& diagnostics);

}  // namespace coopdyn::rosiml
