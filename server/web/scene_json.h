// SPDX-License-Identifier: MIT
// What the page's 3D view draws: one scene as JSON, and its meshes (docs/protocol.md). Pure; any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/state/frame.h"

namespace coopdyn {

/// Floor, things, robots, targets and lights of the frame's scene. Bodies are places in pose messages; robots
/// of one model and fidelity share a description. `number`: by which pose messages call this scene.
std::string SceneJson(const Frame& frame, std::uint32_t number);

/// The mesh with the content `id` that a robot of the scene looks like, as binary glTF; empty if there is
/// none.
std::string MeshGlb(const Scene& scene, std::uint64_t id);

/// A texture of a thing or the floor, by its name; null if there is none.
std::shared_ptr<const Image> FindTextureImage(const Scene& scene, const std::string& name);

/// The picture as a BMP file.
std::string BitmapOf(const Image& image);

}  // namespace coopdyn
