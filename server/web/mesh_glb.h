// SPDX-License-Identifier: MIT
// Meshes of robots for the page's 3D view, as binary glTF 2.0 (Khronos). Triangles with a texture are a
// primitive of their own, whose material names the texture in `extras.texture`: an address at /api/texture/.
// Pure; any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "server/state/frame.h"

namespace coopdyn {

/// The mesh `id` of a robot in the scene; empty if unknown.
std::string MeshGlb(const Scene& scene, std::uint64_t id);

/// The name of a mesh's texture is this, then the mesh's hexadecimal id, ':', and the number of the material.
inline constexpr std::string_view kMeshTexture = "mesh:";

/// The texture of this name; null if unknown.
std::shared_ptr<const Image> MeshTexture(const Scene& scene, std::string_view name);

}  // namespace coopdyn
