// SPDX-License-Identifier: MIT
// Meshes that no file has: terrain, a box that a picture lies on, a mesh in another picture. Pure; any
// thread.
#pragma once

#include "server/files/wire.h"
#include "server/model/mesh_file.h"

namespace coopdyn {

/// A terrain of columns x rows points about `pos`, m. Black lies at 0, the brightest point at the size's
/// height; the upper edge of the picture is +y.
ModelMesh MakeHeights(const Heights& heights, int columns, int rows, const Vector3& size, const Vector3& pos);

/// A box about the origin with the whole picture on each side.
ModelMesh MakePictureBox(const Vector3& size);

/// `bare` with this material all over.
ModelMesh InMaterial(const ModelMesh& bare, const MeshSkin::Material& material);

}  // namespace coopdyn
