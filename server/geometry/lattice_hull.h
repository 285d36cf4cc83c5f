// SPDX-License-Identifier: MIT
// Convex hulls of points with integer coordinates: exact, so they have no folds and their volumes add up.
// Pure; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace coopdyn {

/// Coordinates from 0 to kLatticeSide.
using LatticePoint = std::array<std::int64_t, 3>;
inline constexpr std::int64_t kLatticeSide = 1 << 16;

/// A convex hull that grows point by point.
class LatticeHull {
 public:
  /// @pre the four do not lie in a plane
  LatticeHull(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c, const LatticePoint& d);

  void Include(const LatticePoint& p);
  void Include(const LatticeHull& other) {
    for (const LatticePoint& p : other.Corners()) Include(p);
  }
  /// Six times the hull's volume.
  std::int64_t volume6() const { return volume6_; }
  std::vector<LatticePoint> Corners() const;
  /// The largest distance of `p` outside the plane of a face; 0 if `p` is inside.
  double Outside(const LatticePoint& p) const;

 private:
  struct Face {
    std::array<std::uint32_t, 3> corners{};  // counter-clockwise from outside
    LatticePoint n{};
    std::int64_t d = 0;  // n · p of the points in it

    std::int64_t Height(const LatticePoint& p) const { return n[0] * p[0] + n[1] * p[1] + n[2] * p[2] - d; }
  };
  void AddFace(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  std::vector<LatticePoint> points_;  // includes points that are inside by now
  std::vector<Face> faces_;
  // Buffer of Include(). An edge packs its lower corner, its higher corner, and whether it runs low to high.
  std::vector<std::uint64_t> edges_;
  std::int64_t volume6_ = 0;
};

/// The corners of the convex hull of points in a plane, counter-clockwise, without collinear ones. Sorts
/// `points`.
std::vector<std::array<std::int64_t, 2>> HullInPlane(std::vector<std::array<std::int64_t, 2>>& points);

}  // namespace coopdyn
