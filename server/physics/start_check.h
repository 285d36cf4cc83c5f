// SPDX-License-Identifier: MIT
// What must be right before the first step. Pure; whoever builds a world calls it.
#pragma once

#include <span>

#include "server/base/diagnostics.h"
#include "server/state/frame.h"

namespace coopdyn {

struct OdeWorld;

/// Reports robots whose model cannot be simulated (a link without mass). Call before BuildOdeWorld().
void CheckModels(const Scene& scene, Diagnostics& diagnostics);
/// Reports every dynamic thing that starts more than 1 mm inside another or below the floor, and by how much.
/// `bodies` as Frame::bodies.
void CheckStart(OdeWorld& ode, std::span<const BodyState> bodies, Diagnostics& diagnostics);

}  // namespace coopdyn
