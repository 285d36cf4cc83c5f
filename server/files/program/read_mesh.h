// SPDX-License-Identifier: MIT
// Meshes from files, by libassimp. One thread.
#pragma once

#include <optional>
#include <string>

#include "server/files/program/mesh_skin.h"
#include "server/files/wire.h"

namespace coopdyn {

/// The triangles of a .stl, .obj, .dae, .glb, .gltf or .ply file. `ask`: for what it names. Nothing, and
/// `why` says what to do, if it cannot be read.
std::optional<MeshAnswer> ReadMesh(const MeshRequest& request, const AskForFile& ask, std::string& why);

}  // namespace coopdyn
