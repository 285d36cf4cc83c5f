// SPDX-License-Identifier: MIT
// Writes a compiled MJCF model as an SDF world. One thread.
#pragma once

#include <string>

#include "server/mjcf/meshes.h"
#include "server/mjcf/source.h"

namespace coopdyn::mjcf {

/// Joined bodies form one model: a robot if it moves, else <static>. The origin of a free robot is in its
/// first body, that of any other robot on the floor below its first body.
std::string WriteWorld(const Source& source, Meshes& meshes);

}  // namespace coopdyn::mjcf
