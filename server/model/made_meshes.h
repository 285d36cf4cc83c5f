// SPDX-License-Identifier: MIT
// Generated meshes: terrain, a textured box, a mesh with another material. Pure; any thread.
#pragma once

#include "server/files/wire.h"
#include "server/model/mesh_file.h"

namespace coopdyn {

/// A terrain of columns x rows points about `pos`, m. Black is at height 0, the brightest point at size.z();
/// the picture's top edge is at +y.
ModelMesh MakeHeights(const Heights& heights, int columns, int rows, const Vector3& size, const Vector3& pos);

/// A box about the origin with the whole picture on each side.
ModelMesh MakePictureBox(const Vector3& size);

/// `bare` with one material for the whole mesh.
ModelMesh InMaterial(const ModelMesh& bare, const MeshSkin::Material& material);

}  // namespace coopdyn
