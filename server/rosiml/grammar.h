// SPDX-License-Identifier: MIT
// The words of both grammars, as tables, and the check of a file against them. Pure; any thread.
#pragma once

#include <string>

#include "server/base/diagnostics.h"
#include "server/rosiml/xml.h"

namespace coopdyn::rosiml {

/// RoSiML as the YARS paper tells it (<movables>), or the grammar 0.8 of the public YARS (<robots>).
enum class Dialect { kPaper, kPublic };
Dialect DialectOf(const Element& root);

/// Reports elements and attributes that the grammar does not know or that are missing or stand twice, and
/// values that cannot be. Warns, once for each kind, of what coopdyn does not simulate yet. What is taken for
/// a slip of the pen gets its right name, so that the reader goes on without more mistakes.
void CheckGrammar(Element& root, Dialect dialect, const std::string& file, Diagnostics& diagnostics);

}  // namespace coopdyn::rosiml
