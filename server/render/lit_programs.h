// SPDX-License-Identifier: MIT
// The shader programs for lit surfaces with a given number of lamps. Use and destroy them on the context's
// thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "server/render/gl_objects.h"
#include "server/render/shaders.h"
#include "server/state/scene.h"

namespace coopdyn {

inline constexpr std::size_t kMostLamps = 8;

/// The number of lamps that light pictures of `scene`.
inline std::size_t LampsOf(const Scene& scene) {
  return std::min(scene.lights.size(), kMostLamps);
}

/// A shader's source. `variant`: definitions before its body.
inline std::string Source(const char* body, const std::string& variant = "") {
  return shaders::kHeader + variant + body;
}

struct LitPrograms {
  LitPrograms(const GlApi& gl, std::size_t lamp_count, std::string& error)
      : lamps(lamp_count),
        mesh(gl, Source(shaders::kMeshVertex), Lit(shaders::kMeshFragment), error),
        skin(gl, Source(shaders::kMeshVertex, kSkin), Lit(shaders::kMeshFragment, kSkin), error),
        clad(gl, Source(shaders::kMeshVertex, kClad), Lit(shaders::kMeshFragment, kClad), error),
        floor(gl, Source(shaders::kFloorVertex), Lit(shaders::kFloorFragment), error) {}

  const std::size_t lamps;
  GlProgram mesh, skin, clad, floor;

 private:
  static constexpr const char *kSkin = "#define SKIN\n", *kClad = "#define CLAD\n";

  std::string Lit(const char* body, const std::string& variant = "") const {
    return Source(body, "#define LAMPS " + std::to_string(lamps) + "\n" + variant + shaders::kLight);
  }
};

}  // namespace coopdyn
