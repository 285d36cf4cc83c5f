// SPDX-License-Identifier: MIT
// Reads mesh files with libassimp. One thread.
#pragma once

#include <optional>
#include <string>

#include "server/files/program/mesh_skin.h"
#include "server/files/wire.h"

namespace coopdyn {

/// The triangles of a .stl, .obj, .dae, .glb, .gltf or .ply file. `ask` returns the files that it refers to.
/// Returns nullopt if the file cannot be read; `why` then says what to do.
std::optional<MeshAnswer> ReadMesh(const MeshRequest& request, const AskForFile& ask, std::string& why);

}  // namespace coopdyn
