// SPDX-License-Identifier: MIT
#include "server/model/swarm.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>
#include <variant>

#include "server/base/portable_math.h"
#include "server/base/random.h"
#include "server/geometry/uniform_grid.h"
#include "server/model/section_reader.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr double kGap_m = 0.01;  // between a robot and anything outside its swarm
constexpr int kTriesPerRobot = 2000;

/// A spatial hash of places, to find those near a point.
class PlaceHash {
 public:
  explicit PlaceHash(double cell_m) : cell_m_(cell_m) {}

  void Add(double x, double y, double keep_m) {
    largest_ = std::max(largest_, keep_m);
    cells_[Key(Cell(x), Cell(y))].push_back({x, y, keep_m});
  }

  /// True if (x, y) is at least each added place's own distance away from it.
  bool IsFree(double x, double y) const {
    const auto reach = static_cast<std::int64_t>(std::ceil(largest_ / cell_m_));
    for (std::int64_t i = Cell(x) - reach; i <= Cell(x) + reach; ++i) {
      for (std::int64_t j = Cell(y) - reach; j <= Cell(y) + reach; ++j) {
        const auto cell = cells_.find(Key(i, j));
        if (cell == cells_.end()) continue;
        for (const Place& place : cell->second) {
          if (portable::Hypot(place.x - x, place.y - y) < place.keep_m) return false;
        }
      }
    }
    return true;
  }

 private:
  struct Place {
    double x, y, keep_m;
  };
  std::int64_t Cell(double x) const { return static_cast<std::int64_t>(std::floor(x / cell_m_)); }
  static std::uint64_t Key(std::int64_t i, std::int64_t j) {
    return (static_cast<std::uint64_t>(i) << 32) ^ (static_cast<std::uint64_t>(j) & 0xFFFFFFFFu);
  }

  double cell_m_;
  double largest_ = 0;
  std::unordered_map<std::uint64_t, std::vector<Place>> cells_;
};

/// The objects that a robot could touch, in a grid.
class Obstacles {
 public:
  Obstacles(std::span<const WorldObject> objects, const SwarmRequest& request)
      : objects_(objects), keep_m_(request.radius_m + kGap_m) {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const WorldObject& object = objects[i];
      const Vector3 half = HalfExtents(object.shape, object.X_WO.q);
      const Vector3& p = object.X_WO.p;
      if (p.z() - half.z() >= request.height_m || p.z() + half.z() <= 0) continue;
      indices_.push_back(i);
      boxes_.push_back({p.x() - half.x() - keep_m_, p.y() - half.y() - keep_m_, p.x() + half.x() + keep_m_,
                        p.y() + half.y() + keep_m_});
    }
    if (!boxes_.empty()) grid_.Build(boxes_, std::max(4 * request.radius_m, 0.5));
  }

  bool IsFree(double x, double y) const {
    bool is_free = true;
    grid_.VisitOverlaps(boxes_, {x, y, x, y}, [&](std::uint32_t item) {
      return is_free = DistanceToShadow(objects_[indices_[item]], x, y) >= keep_m_;
    });
    return is_free;
  }

 private:
  std::span<const WorldObject> objects_;
  double keep_m_;
  std::vector<std::size_t> indices_;  // index of each box's object
  std::vector<Aabb2> boxes_;
  UniformGrid grid_;
};

}  // namespace

double FootprintRadius(const Shape& shape, const Quaternion& q) {
  const bool upright = std::abs(q.toRotationMatrix()(2, 2)) > 1 - 1e-9;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius_m;
  const auto* cylinder = std::get_if<Cylinder>(&shape);
  if (cylinder != nullptr && upright) return cylinder->radius_m;
  const auto* box = std::get_if<Box>(&shape);
  if (box != nullptr && upright) return portable::Hypot(box->size_m.x(), box->size_m.y()) / 2;
  const Vector3 half = HalfExtents(shape, q);
  return portable::Hypot(half.x(), half.y());
}

double DistanceToShadow(const WorldObject& object, double x_m, double y_m) {
  const Vector3& centre = object.X_WO.p;
  const Matrix3 R = object.X_WO.q.toRotationMatrix();
  const bool upright = std::abs(R(2, 2)) > 1 - 1e-9;
  const double dx = x_m - centre.x(), dy = y_m - centre.y();
  if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
    return std::max(0.0, portable::Hypot(dx, dy) - sphere->radius_m);
  }
  const auto* cylinder = std::get_if<Cylinder>(&object.shape);
  if (cylinder != nullptr && upright) return std::max(0.0, portable::Hypot(dx, dy) - cylinder->radius_m);
  const auto* box = std::get_if<Box>(&object.shape);
  if (box != nullptr && upright) {
    // In the box's own axes.
    const double ax = std::abs(R(0, 0) * dx + R(1, 0) * dy) - box->size_m.x() / 2;
    const double ay = std::abs(R(0, 1) * dx + R(1, 1) * dy) - box->size_m.y() / 2;
    return portable::Hypot(std::max(0.0, ax), std::max(0.0, ay));
  }
  const Vector3 half = HalfExtents(object.shape, object.X_WO.q);
  return portable::Hypot(std::max(0.0, std::abs(dx) - half.x()), std::max(0.0, std::abs(dy) - half.y()));
}

std::vector<FloorPlace> PlaceSwarm(const SwarmRequest& request, std::span<const WorldObject> objects,
                                   std::span<const FloorPlace> taken) {
  std::vector<FloorPlace> places;
  const double length = request.area.length_m - 2 * request.radius_m;
  const double width = request.area.width_m - 2 * request.radius_m;
  if (length < 0 || width < 0) return places;
  const Obstacles obstacles(objects, request);
  double largest_m = 0.1;
  for (const FloorPlace& place : taken)
    largest_m = std::max(largest_m, place.radius_m + request.radius_m + kGap_m);
  PlaceHash others(largest_m), own(std::max(request.spacing_m, 0.01));
  for (const FloorPlace& place : taken)
    others.Add(place.x_m, place.y_m, place.radius_m + request.radius_m + kGap_m);
  RandomNumbers random(request.seed);
  for (int robot = 0; robot < request.count; ++robot) {
    bool found = false;
    for (int attempt = 0; attempt < kTriesPerRobot && !found; ++attempt) {
      const double x = request.area.center_x_m + (random.Next() - 0.5) * length;
      const double y = request.area.center_y_m + (random.Next() - 0.5) * width;
      const double heading = (random.Next() * 2 - 1) * std::numbers::pi;
      if (!own.IsFree(x, y) || !others.IsFree(x, y) || !obstacles.IsFree(x, y)) continue;
      own.Add(x, y, request.spacing_m);
      places.push_back({x, y, heading, request.radius_m});
      found = true;
    }
    if (!found) break;
  }
  return places;
}

std::string DoNotFit(const SwarmRequest& request, std::size_t fit, const std::string& what) {
  return "only " + std::to_string(fit) + " of " + std::to_string(request.count) + " " + what +
         " fit into the area of " + FormatNumber(request.area.length_m) + " x " +
         FormatNumber(request.area.width_m) + " m, " + FormatNumber(request.spacing_m) +
         " m apart and clear of what stands there: take fewer, a smaller spacing or a larger area";
}

namespace {

/// The copies of one section. Reports an error at its line and returns none if they do not fit.
std::vector<WorldObject> PlaceCopies(const ScatteredObjects& things, const Scenario& scenario,
                                     std::span<const FloorPlace> taken, Diagnostics& diagnostics) {
  const Vector3 half = HalfExtents(things.object.shape, things.object.X_WO.q);
  SwarmRequest request;
  request.count = static_cast<int>(things.count);
  request.radius_m = FootprintRadius(things.object.shape, things.object.X_WO.q);
  request.height_m = 2 * half.z();
  request.spacing_m = things.spacing_m.value_or(2.5 * request.radius_m);
  request.area = things.area.value_or(FloorArea{0, 0, scenario.floor.length_m, scenario.floor.width_m});
  request.seed = things.seed.value_or(scenario.simulation.seed);

  std::vector<WorldObject> copies;
  const auto error = [&](std::string text) { diagnostics.Error(things.object.where, std::move(text)); };
  if (request.spacing_m < 2 * request.radius_m) {
    error("'spacing' is the distance between the middles of two copies: at least " +
          FormatNumber(2 * request.radius_m) + " m, so that they are clear of one another however they turn");
    return copies;
  }
  const std::vector<FloorPlace> places = PlaceSwarm(request, scenario.objects, taken);
  if (places.size() < things.count) {
    error(DoNotFit(request, places.size(), "copies of [" + things.object.name + "]"));
    return copies;
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    WorldObject& copy = copies.emplace_back(things.object);
    copy.name += "_" + std::to_string(i + 1);
    copy.X_WO.p = Vector3(places[i].x_m, places[i].y_m, half.z());
    copy.X_WO.q = FromRollPitchYaw(0, 0, places[i].heading_rad) * things.object.X_WO.q;
  }
  return copies;
}

}  // namespace

void AddScattered(std::span<const ScatteredObjects> sections, std::span<const FloorPlace> taken,
                  Scenario& scenario, Diagnostics& diagnostics) {
  if (sections.empty()) return;
  std::unordered_map<std::string, SourceLine> names;  // of the objects, in lower case
  for (const WorldObject& object : scenario.objects) names.emplace(ToLower(object.name), object.where);
  std::uint64_t wanted = 0;
  for (const ScatteredObjects& things : sections) {
    wanted += things.count;
    if (wanted > kMaxSwarms) {
      diagnostics.Error(things.object.where, "all copies together are more than " +
                                                 std::to_string(kMaxSwarms) + ": take smaller counts");
      return;
    }
    for (WorldObject& copy : PlaceCopies(things, scenario, taken, diagnostics)) {
      const auto [first, is_new] = names.emplace(ToLower(copy.name), copy.where);
      if (!is_new) {
        diagnostics.Error(copy.where, "a copy is called [" + copy.name + "] as another thing is (" +
                                          first->second.file + ":" + std::to_string(first->second.line) +
                                          "): give the section another name");
        break;
      }
      scenario.objects.push_back(std::move(copy));
    }
  }
  std::stable_sort(scenario.objects.begin(), scenario.objects.end(),
                   [&scenario](const WorldObject& a, const WorldObject& b) {
                     const bool world_a = a.where.file == scenario.world.file;
                     const bool world_b = b.where.file == scenario.world.file;
                     return world_a != world_b ? world_a : a.where.line < b.where.line;
                   });
}

}  // namespace coopdyn
