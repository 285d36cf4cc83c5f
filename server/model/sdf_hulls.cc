// SPDX-License-Identifier: MIT
// How the meshes of links that move collide: by convex solids.
#include <algorithm>
#include <memory>
#include <utility>

#include "server/model/kept_parts.h"
#include "server/model/sdf_body.h"

namespace coopdyn {

namespace {

/// The convex hull of the points in the frame of `collision`; false, and a thin box instead, if they are
/// flat.
bool TakeHull(std::span<const Vector3> points, RobotModel& robot, LinkShape& collision) {
  Vector3 middle = Vector3::Zero();
  auto hull = ConvexHull(points, middle);
  if (!hull) return false;
  robot.meshes.push_back(std::make_shared<const MeshData>(std::move(*hull)));
  collision.shape = Mesh{robot.meshes.back().get()};
  collision.X_LG.p = collision.X_LG * middle;
  return true;
}

/// As few convex solids as look like the mesh `data`; `pieces` gets all but the first.
void TakeSolids(const MeshData& data, const std::filesystem::path& folder, int index, RobotModel& robot,
                LinkShape& collision, std::vector<LinkShape>& pieces) {
  const PartCorners parts = KeptConvexParts(data, collision.most_parts, folder);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    LinkShape& piece = pieces.emplace_back(collision);
    piece.piece_of = index;
    TakeHull(parts[i], robot, piece);
  }
  if (TakeHull(parts.empty() ? std::span(data.vertices) : std::span(parts[0]), robot, collision)) return;
  constexpr double kThin_m = 1e-3;
  collision.shape = Box{(2 * data.half_m).cwiseMax(kThin_m)};
}

}  // namespace

void MakeHulls(ModelReading& reading) {
  RobotModel& robot = reading.robot;
  constexpr int kMostConcave = 100;  // each takes up to half a second
  int concave = 0;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (robot.fixed_base && i == 0) continue;  // its triangles themselves
    std::vector<LinkShape>& collisions = robot.links[i].collisions;
    std::vector<LinkShape> pieces;
    for (std::size_t c = 0; c < collisions.size(); ++c) {
      const auto* mesh = std::get_if<Mesh>(&collisions[c].shape);
      if (mesh == nullptr) continue;
      const auto source = std::ranges::find(reading.source.meshes, mesh->data,
                                            [](const auto& one) { return one.second.data.get(); });
      if (source != reading.source.meshes.end() && source->second.is_heights) {
        const auto frame = std::ranges::find(robot.frames, robot.links[i].name, &FrameModel::name);
        reading.Error(reading.lines.links[static_cast<std::size_t>(frame - robot.frames.begin())],
                      "link '" + robot.links[i].name +
                          "' moves, and its <heightmap> cannot: fix the link to the world, or write "
                          "<static>true</static>");
        continue;
      }
      if (collisions[c].most_parts > 1 && ++concave > kMostConcave) {
        collisions[c].most_parts = 1;
        if (concave == kMostConcave + 1) {
          const auto frame = std::ranges::find(robot.frames, robot.links[i].name, &FrameModel::name);
          reading.Mended(reading.lines.links[static_cast<std::size_t>(frame - robot.frames.begin())],
                         "the robot has more than " + std::to_string(kMostConcave) +
                             " meshes that collide: from link '" + robot.links[i].name +
                             "' on each is its convex hull");
        }
      }
      TakeSolids(*mesh->data, reading.source.parts_folder, static_cast<int>(c), robot, collisions[c], pieces);
    }
    // After all others: sensors know these by their index.
    collisions.insert(collisions.end(), pieces.begin(), pieces.end());
  }
}

}  // namespace coopdyn
