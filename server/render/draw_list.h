// SPDX-License-Identifier: MIT
// What a picture shows, without GL: the shapes in the field of view with their level of detail, marks on the
// floor, what sensors see and names. Pure function of frame and camera; any thread.
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

/// One shape. World frame, m. The layout is that of the vertex attributes.
struct Instance {
  std::array<float, 9> axes;  // the shape's x, y, z axes in the world
  std::array<float, 3> scale;
  std::array<float, 3> position;
  std::array<float, 3> color;
};

/// All that look like one mesh.
struct MeshDraw {
  const MeshData* mesh = nullptr;
  bool in_skin = false;  // its materials and textures, not the instances' colour
  std::vector<Instance> instances;
};

/// Simple shapes with a picture on them.
struct CladDraw {
  Texture texture;
  std::array<std::vector<Instance>, kMeshCount> meshes;
};

/// A name above a robot, or beside a joint.
struct Label {
  std::string text;
  double x_px = 0, y_px = 0;  // middle of its lower edge
  Color color;
  std::optional<std::array<double, 2>> at_px = std::nullopt;  // a line leads there
};

struct DrawList {
  std::array<std::vector<Instance>, kMeshCount> meshes;
  std::vector<CladDraw> clad;
  std::vector<MeshDraw> model_meshes;      // those of robot models
  std::vector<OverlayVertex> floor_marks;  // drawn where the floor is seen
  std::vector<OverlayVertex> sensor_marks;
  std::vector<OverlayVertex> joint_marks;  // drawn over everything
  std::vector<Label> labels;               // far ones first
};

/// Towards the sun; not normalised, z = 1.
inline const Vector3& SunDirection() {
  static const Vector3 direction(-0.50, -0.62, 1);
  return direction;
}

/// What the instances' colours are: how things look, or in red their numbers in a segmentation, of the finest
/// detail.
enum class Paint { kColors, kNumbers };

/// The numbers of a segmentation; 0 is nothing.
inline constexpr int kFloorNumber = 1, kFirstNumber = 2;

/// Of a robot's camera (`request` has its size) without marks and names.
DrawList MakeDrawList(const Frame& frame, const ImageRequest& request, const Camera& camera,
                      Paint paint = Paint::kColors);

}  // namespace coopdyn
