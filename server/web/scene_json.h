// SPDX-License-Identifier: MIT
// Encodes a scene for the page's 3D view: as JSON, with textures (docs/protocol.md). Pure; any
// thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/state/frame.h"

namespace coopdyn {

/// Floor, things, robots, targets and lights of the frame's scene. "body" is an index into pose messages.
/// Robots of one model and fidelity share a description. `number` identifies this scene in pose messages.
std::string SceneJson(const Frame& frame, std::uint32_t number);

/// A texture of a thing, the floor or a mesh (mesh_glb.h), by its name; null if unknown.
std::shared_ptr<const Image> FindTextureImage(const Scene& scene, const std::string& name);

/// The picture as a BMP file.
std::string BitmapOf(const Image& image);

}  // namespace coopdyn
