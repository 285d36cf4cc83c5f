// SPDX-License-Identifier: MIT
#include "server/geometry/lattice_hull.h"

#include <algorithm>
#include <cmath>

namespace coopdyn {

LatticeHull::LatticeHull(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
                         const LatticePoint& d)
    : points_{a, b, c, d} {
  AddFace(0, 1, 2);
  const std::int64_t height = faces_.front().Height(d);
  volume6_ = height < 0 ? -height : height;
  faces_.clear();
  if (height > 0) std::swap(points_[1], points_[2]);
  AddFace(0, 1, 2);
  AddFace(0, 2, 3);
  AddFace(0, 3, 1);
  AddFace(1, 3, 2);
}

void LatticeHull::AddFace(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  LatticePoint u{}, v{};
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = points_[b][i] - points_[a][i];
    v[i] = points_[c][i] - points_[a][i];
  }
  Face face{{a, b, c}, {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]}, 0};
  face.d = face.Height(points_[a]);
  faces_.push_back(face);
}

// Removes the faces that `p` sees and connects the rim to `p`. With integer coordinates a point in a face's
// plane does not see the face, so no new face is degenerate.
void LatticeHull::Include(const LatticePoint& p) {
  const auto sees = [&](const Face& face) { return face.Height(p) > 0; };
  auto kept = std::ranges::find_if(faces_, sees);
  if (kept == faces_.end()) return;
  edges_.clear();
  for (auto face = kept; face != faces_.end(); ++face) {
    const std::int64_t height = face->Height(p);
    if (height <= 0) {
      *kept++ = *face;
      continue;
    }
    volume6_ += height;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t from = face->corners[i], to = face->corners[(i + 1) % 3];
      edges_.push_back(std::min(from, to) << 32 | std::max(from, to) << 1 | (from < to ? 1 : 0));
    }
  }
  faces_.erase(kept, faces_.end());
  points_.push_back(p);
  std::ranges::sort(edges_);
  const auto apex = static_cast<std::uint32_t>(points_.size() - 1);
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto low = static_cast<std::uint32_t>(edges_[i] >> 32),
               high = static_cast<std::uint32_t>(edges_[i]) >> 1;
    if (i + 1 < edges_.size() && edges_[i + 1] >> 1 == edges_[i] >> 1) {
      ++i;  // between two removed faces
    } else {
      (edges_[i] & 1) != 0 ? AddFace(low, high, apex) : AddFace(high, low, apex);
    }
  }
}

std::vector<LatticePoint> LatticeHull::Corners() const {
  std::vector<bool> used(points_.size());
  for (const Face& face : faces_) {
    for (const std::uint32_t corner : face.corners) used[corner] = true;
  }
  std::vector<LatticePoint> corners;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (used[i]) corners.push_back(points_[i]);
  }
  return corners;
}

double LatticeHull::Outside(const LatticePoint& p) const {
  double outside = 0;
  for (const Face& face : faces_) {
    const std::int64_t height = face.Height(p);
    if (height <= 0) continue;
    double squares = 0;
    for (const std::int64_t x : face.n) squares += static_cast<double>(x) * static_cast<double>(x);
    outside = std::max(outside, static_cast<double>(height) / std::sqrt(squares));
  }
  return outside;
}

// A. M. Andrew (1979), "Another efficient algorithm for convex hulls in two dimensions".
std::vector<std::array<std::int64_t, 2>> HullInPlane(std::vector<std::array<std::int64_t, 2>>& points) {
  std::ranges::sort(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::vector<std::array<std::int64_t, 2>> hull;
  const auto add = [&](const std::array<std::int64_t, 2>& p, std::size_t first) {
    while (hull.size() >= first + 2) {
      const auto &a = hull[hull.size() - 2], &b = hull.back();
      if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
      hull.pop_back();
    }
    hull.push_back(p);
  };
  for (const auto& p : points) add(p, 0);
  const std::size_t half = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], half);
  hull.pop_back();
  return hull;
}

}  // namespace coopdyn
