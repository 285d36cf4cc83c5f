// SPDX-License-Identifier: MIT
// Replies of the program that reads meshes and pictures: none may crash us.
// link: coopdyn_files
#include <cstddef>
#include <cstdint>
#include <span>

#include "server/files/wire.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace coopdyn;
  if (size == 0) return 0;
  const auto bytes = std::as_bytes(std::span(data + 1, size - 1));
  switch (*data % 4) {
    case 0: {
      const auto mesh = MeshAnswerOf(bytes);
      if (!mesh) break;
      Vector3 middle;
      MakeMesh(mesh->parts.vertices, mesh->parts.triangles, middle);
      ToBytes(*mesh);
      break;
    }
    case 1:
      ImageOf(bytes);
      break;
    case 2:
      HeightsOf(bytes);
      break;
    default:
      MeshRequestOf(bytes);
  }
  return 0;
}
