// SPDX-License-Identifier: MIT
// A compiled MJCF model as an SDF world. One thread.
#pragma once

#include <string>

#include "server/mjcf/meshes.h"
#include "server/mjcf/source.h"

namespace coopdyn::mjcf {

/// What is joined is one model: a robot if it moves, else <static>. A free robot has its origin in its first
/// body, any other on the floor below it.
std::string WriteWorld(const Source& source, Meshes& meshes);

}  // namespace coopdyn::mjcf
