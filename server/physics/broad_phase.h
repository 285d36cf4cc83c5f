// SPDX-License-Identifier: MIT
// Finds the things that may touch. Robots are discs in the plane (CircleGrid); objects are boxes in two
// uniform grids, one for dynamic and one for static objects. One thread. Only server/physics includes this
// file.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/geometry/uniform_grid.h"
#include "server/physics/things.h"

namespace coopdyn {

/// A circle in the plane.
struct Circle {
  double x = 0, y = 0, radius_m = 0;
};

/// Finds overlapping circles: the robots of a crowd. Rebuilt on each call (counting sort, no allocation once
/// warm). The grid wraps around like a torus, so distant robots cost no cells. Each circle lies in the cell
/// of its centre. A cell is as wide as the largest diameter, so only neighbouring cells must be checked.
class CircleGrid {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /// Replaces `pairs` by every pair (a < b) of circles that overlap, each once, in increasing order. Circles
  /// that are not finite overlap nothing.
  void FindPairs(std::span<const Circle> circles, std::vector<Pair>& pairs);

 private:
  struct Item {
    double x, y, radius_m;
    std::uint32_t index;
  };
  void Sort(std::span<const Circle> circles);

  double small_m_ = 0;          // larger circles are tested against all
  int columns_ = 0, rows_ = 0;  // powers of two
  std::vector<std::uint32_t> starts_, cells_;
  std::vector<Item> items_;
  std::vector<std::uint32_t> large_;
};

/// The upright cylinder that contains everything a robot may touch in the coming substep.
struct RobotSpace {
  Circle circle;
  double min_z = 0, max_z = 0;
};

/// The space of robot `thing`, widened by `margin_m`. `body`: the first of its bodies, which are adjacent in
/// memory.
RobotSpace SpaceOf(const Thing& thing, const BodyState& body, double margin_m);

class BroadPhase {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /// Fills the grids of objects; `bodies`: as Frame::bodies. @pre `things` outlives it.
  BroadPhase(const Things& things, std::span<const BodyState> bodies);

  /// The robots' spaces, by robot. Update them before FindPairs().
  std::vector<RobotSpace>& spaces() { return spaces_; }
  /// Moves dynamic object `thing` to `body`.
  void MoveObject(std::size_t thing, const BodyState& body);

  /// Finds all pairs of things (a < b) that may touch, if at least one of the two moves (`moves`, by dynamic
  /// thing): first pairs of dynamic things, then pairs with static ones, each in increasing order. Valid
  /// until the next call.
  const std::vector<Pair>& FindPairs(std::span<const std::uint8_t> moves);
  /// Appends the things that may reach into this box, increasing: robots by their spaces, objects by their
  /// present places.
  void FindIn(const Vector3& low_m, const Vector3& high_m, std::vector<std::uint32_t>& found) const;

 private:
  struct Objects {
    std::vector<PlacedPart> parts;
    std::vector<Aabb2> boxes;
    UniformGrid grid;

    void Add(const Actor& actor);
    void Move(std::size_t object, const PlacedPart& part);
    bool OverlapsInHeight(std::size_t object, double min_z, double max_z) const;
  };
  /// Appends to `pairs` those of `objects` that may touch robot `thing`. `first`: thing number of the first
  /// object.
  void FindNear(std::size_t thing, const Objects& objects, std::size_t first, std::vector<Pair>& pairs) const;
  void FindObjects(std::span<const std::uint8_t> moves);
  void FindStatics(std::span<const std::uint8_t> moves);

  const Things& things_;
  Objects objects_, statics_;
  bool objects_moved_ = false;
  std::vector<RobotSpace> spaces_;
  std::vector<Circle> circles_;
  CircleGrid robots_;
  std::vector<Pair> robot_pairs_, pairs_;
};

}  // namespace coopdyn
