// SPDX-License-Identifier: MIT
// Convex parts of meshes, kept in files from one start to the next: what costs tenths of a second is read in
// a millisecond. Any thread, any process.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/geometry/convex_cut.h"
#include "server/geometry/mesh.h"

namespace coopdyn {

/// The corners of each part, as in ConvexCut.
using PartCorners = std::vector<std::vector<Vector3>>;

/// CutConvex() of `mesh`. The parts of a mesh of some size are looked
/// for in `folder` first, and put there. A file there that is damaged, or does not fit the mesh, is made
/// again. Nothing is kept if the folder is empty or cannot be written; it holds at most some 2000 files, of
/// which the oldest go.
ConvexCut KeptConvexCut(const MeshData& mesh, int most, const std::filesystem::path& folder,
                        int cells = kPartCells);
inline PartCorners KeptConvexParts(const MeshData& mesh, int most, const std::filesystem::path& folder) {
  return KeptConvexCut(mesh, most, folder).parts;
}

/// The content of such a file, and back; nothing for bad bytes, or those of another mesh.
std::string PartsToBytes(const PartCorners& parts, const MeshData& mesh, int most, int cells = kPartCells);
std::optional<PartCorners> PartsFromBytes(std::string_view bytes, const MeshData& mesh, int most,
                                          int cells = kPartCells);

}  // namespace coopdyn
