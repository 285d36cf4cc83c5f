// SPDX-License-Identifier: MIT
// Objects that move by more than half of their half size in a substep: they would pass through what is thin,
// so they stop where they first touch it, and the next substep finds them there, with their speed (continuous
// collision by time of impact, as E. Catto, Box2D, does it). One thread. Only server/physics includes this
// file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/broad_phase.h"
#include "server/physics/contacts.h"

namespace coopdyn {

class Sweep {
 public:
  /// Before a substep of `dt_s`: notes which of the `active` objects are fast. @pre `things` outlives the
  /// substep
  void Begin(const Things& things, std::span<const std::uint32_t> active, std::span<const BodyState> bodies,
             double dt_s);
  /// After it: puts fast objects back to where they first touched.
  void End(const Things& things, BroadPhase& broad_phase, Collider& collider, std::span<BodyState> bodies);

 private:
  struct Fast {
    std::uint32_t thing = 0;
    double half_size_m = 0;  // of the sphere that fits into it
    BodyState before, after;
    double end = 1;  // how far it comes on its way
  };
  /// How far `a` comes before it touches `other` (null: the floor); `moving`: if that is fast, too.
  double EndBefore(const Things& things, const Fast& a, const Actor* other, const Fast* moving,
                   Collider& collider);

  std::vector<Fast> fast_;
  std::vector<std::uint32_t> near_;
  std::vector<FoundContact> found_;
};

}  // namespace coopdyn
