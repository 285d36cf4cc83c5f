// SPDX-License-Identifier: MIT
// Replaces collision meshes of moving links by convex solids.
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "server/base/worker_pool.h"
#include "server/model/kept_parts.h"
#include "server/model/sdf_body.h"

namespace coopdyn {

namespace {

struct Solid {
  std::shared_ptr<const MeshData> hull;
  Vector3 middle = Vector3::Zero();  // in the frame of the mesh
};

/// A mesh approximated by a few convex solids.
struct Cutting {
  const MeshData* mesh = nullptr;
  int most_parts = 1;
  std::vector<Solid> solids{};  // empty if the mesh is flat
  bool is_tangled = false;
};

void CutMesh(const std::filesystem::path& folder, int cells, Cutting& cutting) {
  const auto add = [&](std::span<const Vector3> points) {
    Solid solid;
    auto hull = ConvexHull(points, solid.middle);
    if (!hull) return;
    solid.hull = std::make_shared<const MeshData>(std::move(*hull));
    cutting.solids.push_back(std::move(solid));
  };
  const ConvexCut cut = KeptConvexCut(*cutting.mesh, cutting.most_parts, folder, cells);
  cutting.is_tangled = cut.is_tangled;
  for (const auto& corners : cut.parts) add(corners);
  if (cut.parts.empty()) add(cutting.mesh->vertices);
}

class HullMaker {
 public:
  explicit HullMaker(ModelReading& reading) : reading_(reading), robot_(reading.robot) {}

  void Make() {
    Visit([this](LinkModel& link, LinkShape& collision) { Plan(link, collision); });
    if (reading_.diagnostics.has_errors()) return;
    // Meshes are independent, and each takes tenths of a second. If there are many, they are small.
    constexpr int kMostCells = 4'000'000, kLeastCells = 40'000;  // in total, per mesh
    const auto concave = static_cast<int>(
        std::ranges::count_if(cuttings_, [](const Cutting& one) { return one.most_parts > 1; }));
    const int cells = std::clamp(kMostCells / std::max(1, concave), kLeastCells, kPartCells);
    constexpr std::size_t kMostThreads = 8;
    const std::size_t threads =
        std::min({std::size_t{std::thread::hardware_concurrency()}, cuttings_.size(), kMostThreads});
    WorkerPool(static_cast<int>(threads))
        .For(cuttings_.size(), 1, [this, cells](std::size_t first, std::size_t end) {
          for (std::size_t i = first; i < end; ++i)
            CutMesh(reading_.source.parts_folder, cells, cuttings_[i]);
        });
    for (const Cutting& cutting : cuttings_) {
      for (const Solid& solid : cutting.solids) robot_.meshes.push_back(solid.hull);
    }
    std::size_t next = 0;
    Visit([&](LinkModel& link, LinkShape& collision) {
      Take(cuttings_[cutting_of_[next++]], link, collision);
    });
  }

 private:
  /// Visits the mesh collisions of moving links, except those that `act` adds.
  template <typename Act>
  void Visit(const Act& act) {
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      if (robot_.fixed_base && i == 0) continue;  // collides by its triangles
      LinkModel& link = robot_.links[i];
      const std::size_t count = link.collisions.size();
      for (std::size_t c = 0; c < count; ++c) {
        if (std::holds_alternative<Mesh>(link.collisions[c].shape)) act(link, link.collisions[c]);
      }
    }
  }

  int LineOf(const LinkModel& link) const {
    const auto frame = std::ranges::find(robot_.frames, link.name, &FrameModel::name);
    return reading_.lines.links[static_cast<std::size_t>(frame - robot_.frames.begin())];
  }

  void Plan(const LinkModel& link, LinkShape& collision) {
    const MeshData* mesh = std::get<Mesh>(collision.shape).data;
    const auto source = std::ranges::find(reading_.source.meshes, mesh,
                                          [](const auto& one) { return one.second.data.get(); });
    if (source != reading_.source.meshes.end() && source->second.is_heights) {
      reading_.Error(LineOf(link), "link '" + link.name +
                                       "' moves, and its <heightmap> cannot: fix the link to the world, or "
                                       "write <static>true</static>");
      return;
    }
    constexpr int kMostConcave = 100;  // each takes up to a few tenths of a second
    if (collision.most_parts > 1 && ++concave_ > kMostConcave) {
      collision.most_parts = 1;
      if (concave_ == kMostConcave + 1) {
        reading_.Mended(LineOf(link), "the robot has more than " + std::to_string(kMostConcave) +
                                          " meshes that collide: from link '" + link.name +
                                          "' on each is its convex hull");
      }
    }
    const auto [known, is_new] = places_.try_emplace({mesh, collision.most_parts}, cuttings_.size());
    if (is_new) cuttings_.push_back({mesh, collision.most_parts});
    cutting_of_.push_back(known->second);
  }

  void Take(const Cutting& cutting, LinkModel& link, LinkShape& collision) {
    if (cutting.is_tangled) {
      reading_.Mended(LineOf(link), "a mesh of link '" + link.name +
                                        "' collides as its convex hull, as its triangles run through each "
                                        "other: give its <collision> a mesh of the surface alone");
    }
    const int index = static_cast<int>(&collision - link.collisions.data());
    const LinkShape whole = collision;
    for (std::size_t i = 0; i < cutting.solids.size(); ++i) {
      const Solid& solid = cutting.solids[i];
      LinkShape piece = whole;
      piece.shape = Mesh{solid.hull.get()};
      piece.X_LG.p = whole.X_LG * solid.middle;
      if (i == 0) {
        collision = piece;
        continue;
      }
      piece.piece_of = index;
      // Append, because sensors refer to existing collisions by index.
      link.collisions.push_back(std::move(piece));
    }
    if (!cutting.solids.empty()) return;
    constexpr double kThin_m = 1e-3;
    collision.shape = Box{(2 * cutting.mesh->half_m).cwiseMax(kThin_m)};
  }

  ModelReading& reading_;
  RobotModel& robot_;
  int concave_ = 0;
  std::vector<Cutting> cuttings_;
  std::map<std::pair<const MeshData*, int>, std::size_t> places_;  // indices into cuttings_
  std::vector<std::size_t> cutting_of_;                            // for each collision of Visit()
};

}  // namespace

void MakeHulls(ModelReading& reading) {
  HullMaker(reading).Make();
}

}  // namespace coopdyn
