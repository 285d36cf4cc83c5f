// SPDX-License-Identifier: MIT
// Which owners may touch. Robots are discs in the plane (CircleGrid), things are boxes in a uniform grid each
// for those that move and those that do not. One thread. Only server/physics includes this file.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/geometry/uniform_grid.h"
#include "server/physics/circle_grid.h"
#include "server/physics/ode_world.h"

namespace coopdyn {

/// What a robot may touch in the coming substep lies in this upright cylinder.
struct RobotSpace {
  Circle circle;
  double min_z = 0, max_z = 0;
};

/// The space of robot `owner` whose first body is at `body`, widened by `margin_m`.
RobotSpace SpaceOf(const Owner& owner, const BodyState& body, double margin_m);

class BroadPhase {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /// Fills the grid of static things, and that of dynamic objects where they are now.
  explicit BroadPhase(const OdeWorld& ode);

  /// The robots' spaces, by robot; to be brought up to date before FindPairs().
  std::vector<RobotSpace>& spaces() { return spaces_; }
  /// Tells that dynamic object `owner` has moved or turned.
  void MoveObject(const OdeWorld& ode, std::size_t owner);

  /// Finds all pairs of owners (a < b) that may touch, but not those of two that do not move (`moves`, by
  /// dynamic owner): first among the dynamic ones, then with static ones, each in increasing order. Valid
  /// until the next call.
  const std::vector<Pair>& FindPairs(const OdeWorld& ode, std::span<const std::uint8_t> moves);

 private:
  struct Things {
    std::vector<Aabb2> boxes;
    std::vector<double> min_z, max_z;
    UniformGrid grid;
  };
  static void Place(const OdeWorld& ode, std::size_t owner, Things& things, std::size_t at);
  /// Appends to `pairs` what of `things` may touch robot `owner`; the first of things is owner `first`.
  void FindThings(const OdeWorld& ode, std::size_t owner, const Things& things, std::size_t first,
                  std::vector<Pair>& pairs) const;
  void FindObjects(const OdeWorld& ode, std::span<const std::uint8_t> moves);
  void FindStatics(const OdeWorld& ode, std::span<const std::uint8_t> moves);

  Things objects_, statics_;
  bool objects_moved_ = false;
  std::vector<RobotSpace> spaces_;
  std::vector<Circle> circles_;
  CircleGrid robots_;
  std::vector<Pair> robot_pairs_, pairs_;
  std::vector<std::uint32_t> found_;
};

}  // namespace coopdyn
