// SPDX-License-Identifier: MIT
// Caches convex parts of meshes in files: reading them takes a millisecond, computing them tenths of a
// second. Any thread, any process.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/geometry/convex_cut.h"
#include "server/geometry/mesh.h"

namespace coopdyn {

/// The corners of each part, see ConvexCut.
using PartCorners = std::vector<std::vector<Vector3>>;

/// CutConvex() of `mesh`, cached in `folder` unless the mesh is small. Recomputes the parts if their file is
/// damaged or does not match the mesh. Caches nothing if `folder` is empty or not writable. The folder holds
/// about 2000 files at most; the oldest are removed.
ConvexCut KeptConvexCut(const MeshData& mesh, int most, const std::filesystem::path& folder,
                        int cells = kPartCells);
inline PartCorners KeptConvexParts(const MeshData& mesh, int most, const std::filesystem::path& folder) {
  return KeptConvexCut(mesh, most, folder).parts;
}

/// Serialize the content of a cache file and back; nullopt for bad bytes or another mesh.
std::string PartsToBytes(const PartCorners& parts, const MeshData& mesh, int most, int cells = kPartCells);
std::optional<PartCorners> PartsFromBytes(std::string_view bytes, const MeshData& mesh, int most,
                                          int cells = kPartCells);

}  // namespace coopdyn
