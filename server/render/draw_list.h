// SPDX-License-Identifier: MIT
// The contents of a picture, without GL: the shapes in the field of view with their level of detail, marks on
// the floor, sensor marks and names. Pure function of frame and camera; any thread.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/model/world_model.h"
#include "server/render/camera.h"
#include "server/render/meshes.h"
#include "server/render/overlay.h"
#include "server/state/frame.h"

namespace coopdyn {

/// One shape. World frame, m. The memory layout is that of the vertex attributes.
struct MeshInstance {
  std::array<float, 9> axes;  // the shape's x, y, z axes in the world
  std::array<float, 3> scale;
  std::array<float, 3> position;
  std::array<float, 3> color;
};

/// All instances of one mesh.
struct MeshDraw {
  const MeshData* mesh = nullptr;
  bool in_skin = false;  // draw with its own materials and textures, not the instances' colour
  std::vector<MeshInstance> instances;
};

/// Simple shapes covered with a texture.
struct CladDraw {
  Texture texture;
  std::array<std::vector<MeshInstance>, kMeshCount> meshes;
};

/// A name above a robot, or beside a joint.
struct Label {
  std::string text;
  double x_px = 0, y_px = 0;  // middle of the lower edge
  Color color;
  std::optional<std::array<double, 2>> at_px = std::nullopt;  // draw a line to this pixel
};

struct DrawList {
  std::array<std::vector<MeshInstance>, kMeshCount> meshes;
  std::vector<CladDraw> clad;
  std::vector<MeshDraw> model_meshes;      // meshes of robot models
  std::vector<OverlayVertex> floor_marks;  // drawn where the floor is visible
  std::vector<OverlayVertex> sensor_marks;
  std::vector<OverlayVertex> joint_marks;  // drawn over everything
  std::vector<Label> labels;               // far ones first
};

/// Towards the sun: over the left shoulder of the default camera; not normalised, z = 1.
inline const Vector3& SunDirection() {
  static const Vector3 direction(-0.66, -0.56, 1);
  return direction;
}

/// The instances' colours: natural colours, or the segmentation number in red, with the finest level of
/// detail.
enum class Paint { kColors, kNumbers };

/// Segmentation numbers; 0 means nothing.
inline constexpr int kFloorNumber = 1, kFirstNumber = 2;

/// Makes the list. For a robot's camera (`request` has its size) it has no marks and names.
DrawList MakeDrawList(const Frame& frame, const ImageRequest& request, const Camera& camera,
                      Paint paint = Paint::kColors);

}  // namespace coopdyn
