// SPDX-License-Identifier: MIT
// What must be right before the first step. Pure; whoever builds a world calls it.
#pragma once

#include "server/base/diagnostics.h"
#include "server/state/scene.h"

namespace coopdyn {

struct Things;

/// Reports robots whose model cannot be simulated (a link without mass). Call before MakeThings().
void CheckModels(const Scene& scene, Diagnostics& diagnostics);
/// Reports every dynamic thing that starts more than 1 mm inside another or below the floor, and by how much.
void CheckStart(const Scene& scene, const Things& things, Diagnostics& diagnostics);

}  // namespace coopdyn
