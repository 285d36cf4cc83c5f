// SPDX-License-Identifier: MIT
// Objects that move by more than half of their half size in a substep could pass through thin things. Such an
// object stops where it first touches something, keeps its speed, and the next substep finds it there
// (continuous collision by time of impact, as in E. Catto's Box2D). One that touches already, and that a
// corner holds while it turns on into a wall, stops where it would go deeper, and loses some of its rates.
// One thread. Only server/physics includes this file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/broad_phase.h"
#include "server/physics/contacts.h"

namespace coopdyn {

class Sweep {
 public:
  /// Notes which of the `active` objects are fast. Call before a substep of `dt_s`.
  /// @pre `things` outlives the substep
  void Begin(const Things& things, std::span<const std::uint32_t> active, std::span<const BodyState> bodies,
             double dt_s);
  /// Moves fast objects back to where they first touched something. Call after the substep.
  void End(const Things& things, BroadPhase& broad_phase, Collider& collider, std::span<BodyState> bodies);

 private:
  struct Fast {
    std::uint32_t thing = 0;
    double half_size_m = 0;  // radius of a sphere that fits into it
    BodyState before, after;
    double end = 1;        // share of the way before it touches
    bool touched = false;  // what ends its way touched it from the start: contacts have changed its rates
    bool yields = false;   // it or what ends its way does
  };
  /// Ends the way of `a` where it touches `other` (null: the floor) or, if it touches it from the start,
  /// where it would go deeper. `moving`: `other`, if it is fast too, whose way ends as well; else null.
  void EndAt(const Things& things, Fast& a, const Actor* other, Fast* moving, Collider& collider);

  std::vector<Fast> fast_;
  std::vector<std::uint32_t> near_;
  std::vector<FoundContact> found_;
};

}  // namespace coopdyn
