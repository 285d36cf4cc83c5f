// SPDX-License-Identifier: MIT
#include "server/geometry/cell_cuts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace coopdyn {

namespace {

using Flat = std::array<std::int64_t, 2>;

/// The solid cells of a box in layers along each axis, with the extent of each row of a layer.
class Layers {
 public:
  Layers(const CellGrid& grid, const CellBox& box) : grid_(grid), box_(box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows_[axis].resize(Length(axis) * Length((axis + 2) % 3));
      volumes_[axis].resize(Length(axis));
      faces_[axis].resize(Length(axis));
    }
    CellGrid::Place cell{};
    for (cell[0] = box.low[0]; cell[0] < box.high[0]; ++cell[0]) {
      for (cell[1] = box.low[1]; cell[1] < box.high[1]; ++cell[1]) {
        for (cell[2] = box.low[2]; cell[2] < box.high[2]; ++cell[2]) {
          const bool is_solid = grid.IsSolid(cell);
          if (is_solid) Add(cell);
          for (std::size_t axis = 0; axis < 3; ++axis) {
            if (cell[axis] == box.low[axis]) continue;
            CellGrid::Place before = cell;
            --before[axis];
            if (grid.IsSolid(before) != is_solid) faces_[axis][At(axis, cell[axis])] += Area(axis, cell);
          }
        }
      }
    }
  }

  bool IsEmpty(std::size_t axis, int layer) const { return volumes_[axis][At(axis, layer)] == 0; }
  /// The volume of a layer's cells.
  std::int64_t Volume(std::size_t axis, int layer) const { return volumes_[axis][At(axis, layer)]; }

  /// The area of the solid's surface in the plane before a layer.
  std::int64_t Face(std::size_t axis, int layer) const { return faces_[axis][At(axis, layer)]; }
  /// The volume between the first and the last solid cell of all rows along an axis. Only cuts across that
  /// axis remove its non-solid part.
  double Spanned(std::size_t axis) const {
    const std::size_t layer_axis = (axis + 2) % 3, row_axis = (axis + 1) % 3;
    double volume = 0;
    for (int layer = box_.low[layer_axis]; layer < box_.high[layer_axis]; ++layer) {
      for (int row = box_.low[row_axis]; row < box_.high[row_axis]; ++row) {
        const Row& reach = rows_[layer_axis][At(layer_axis, layer) * Length(row_axis) + At(row_axis, row)];
        if (reach.high <= reach.low) continue;
        volume += static_cast<double>((grid_.plane(axis, reach.high) - grid_.plane(axis, reach.low)) *
                                      (grid_.plane(row_axis, row + 1) - grid_.plane(row_axis, row)) *
                                      (grid_.plane(layer_axis, layer + 1) - grid_.plane(layer_axis, layer)));
      }
    }
    return volume;
  }
  /// The hull of a layer's cells, as a prism: its corners in the plane of the next two axes.
  std::vector<Flat> Corners(std::size_t axis, int layer) const {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::vector<Flat> points;
    for (int row = box_.low[v]; row < box_.high[v]; ++row) {
      const Row& reach = rows_[axis][At(axis, layer) * Length(v) + At(v, row)];
      if (reach.high <= reach.low) continue;
      for (const int end : {reach.low, reach.high}) {
        for (const int side : {row, row + 1}) points.push_back({grid_.plane(u, end), grid_.plane(v, side)});
      }
    }
    return HullInPlane(points);
  }

 private:
  struct Row {
    int low = std::numeric_limits<int>::max(), high = 0;
  };

  std::size_t Length(std::size_t axis) const {
    return static_cast<std::size_t>(box_.high[axis] - box_.low[axis]);
  }
  std::size_t At(std::size_t axis, int i) const { return static_cast<std::size_t>(i - box_.low[axis]); }

  std::int64_t Width(std::size_t axis, const CellGrid::Place& cell) const {
    return grid_.plane(axis, cell[axis] + 1) - grid_.plane(axis, cell[axis]);
  }
  std::int64_t Area(std::size_t axis, const CellGrid::Place& cell) const {
    return Width((axis + 1) % 3, cell) * Width((axis + 2) % 3, cell);
  }

  void Add(const CellGrid::Place& cell) {
    const std::int64_t volume = Area(0, cell) * Width(0, cell);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      Row& row = rows_[axis][At(axis, cell[axis]) * Length(v) + At(v, cell[v])];
      row.low = std::min(row.low, cell[u]);
      row.high = std::max(row.high, cell[u] + 1);
      volumes_[axis][At(axis, cell[axis])] += volume;
    }
  }

  const CellGrid& grid_;
  const CellBox& box_;
  std::array<std::vector<Row>, 3> rows_;
  std::array<std::vector<std::int64_t>, 3> volumes_, faces_;
};

/// True if `p` is in the polygon `corners`, which is ordered as by HullInPlane().
bool IsIn(const Flat& p, const std::vector<Flat>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Flat &a = corners[i], &b = corners[i + 1 == corners.size() ? 0 : i + 1];
    if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) < 0) return false;
  }
  return true;
}

/// A hull that grows layer by layer.
class Growing {
 public:
  Growing(const CellGrid& grid, std::size_t axis) : grid_(grid), axis_(axis) {}

  /// `corners` must live until the next call.
  void Include(int layer, const std::vector<Flat>& corners) {
    const auto at = [&](const Flat& p, int side) {
      LatticePoint point{};
      point[axis_] = grid_.plane(axis_, layer + side);
      point[(axis_ + 1) % 3] = p[0];
      point[(axis_ + 2) % 3] = p[1];
      return point;
    };
    if (!hull_) hull_.emplace(at(corners[0], 0), at(corners[1], 0), at(corners[2], 0), at(corners[0], 1));
    // In the plane between this layer and the last one, few corners lie outside the hull.
    const int shared = last_corners_ == nullptr   ? -1
                       : layer == last_layer_ + 1 ? 0
                       : layer == last_layer_ - 1 ? 1
                                                  : -1;
    for (const Flat& p : corners) {
      for (const int side : {0, 1}) {
        if (side != shared || !IsIn(p, *last_corners_)) hull_->Include(at(p, side));
      }
    }
    last_corners_ = &corners;
    last_layer_ = layer;
  }
  std::int64_t volume6() const { return hull_ ? hull_->volume6() : 0; }
  const LatticeHull& hull() const { return *hull_; }

 private:
  const CellGrid& grid_;
  std::size_t axis_;
  std::optional<LatticeHull> hull_;
  const std::vector<Flat>* last_corners_ = nullptr;
  int last_layer_ = 0;
};

/// The corners of each layer of a box; an empty layer has none.
std::vector<std::vector<Flat>> CornersOf(const Layers& layers, const CellBox& box, std::size_t axis) {
  std::vector<std::vector<Flat>> corners;
  for (int layer = box.low[axis]; layer < box.high[axis]; ++layer)
    corners.push_back(layers.IsEmpty(axis, layer) ? std::vector<Flat>() : layers.Corners(axis, layer));
  return corners;
}

/// The piece of the solid cells in `box`; nullopt if it has none.
std::optional<Piece> PieceIn(const CellGrid& grid, const CellBox& box) {
  const Layers layers(grid, box);
  CellBox filled = box;
  std::size_t shortest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    int &low = filled.low[axis], &high = filled.high[axis];
    while (low < high && layers.IsEmpty(axis, low)) ++low;
    while (low < high && layers.IsEmpty(axis, high - 1)) --high;
    if (low == high) return std::nullopt;
    if (high - low < filled.high[shortest] - filled.low[shortest]) shortest = axis;
  }
  const std::vector<std::vector<Flat>> corners = CornersOf(layers, filled, shortest);
  Growing growing(grid, shortest);
  std::int64_t cells = 0;
  for (int layer = filled.low[shortest]; layer < filled.high[shortest]; ++layer) {
    cells += layers.Volume(shortest, layer);
    const auto& points = corners[static_cast<std::size_t>(layer - filled.low[shortest])];
    if (!points.empty()) growing.Include(layer, points);
  }
  return Piece{filled, growing.hull(), 6 * cells};
}

struct BestCut {
  std::size_t axis = 0;
  int plane = 0;  // cuts before the layer of this index
};

BestCut FindBestCut(const CellGrid& grid, const Piece& piece) {
  const CellBox& box = piece.box;
  const Layers layers(grid, box);
  std::array<double, 3> areas{};  // of the box's faces across each axis
  for (std::size_t axis = 0; axis < 3; ++axis) {
    areas[axis] = 1;
    for (const std::size_t side : {(axis + 1) % 3, (axis + 2) % 3})
      areas[axis] *= static_cast<double>(grid.plane(side, box.high[side]) - grid.plane(side, box.low[side]));
  }
  const auto hull6 = static_cast<double>(piece.hull.volume6());
  const std::int64_t cells = piece.cells6 / 6;
  BestCut cut;
  double best = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int low = box.low[axis], high = box.high[axis];
    if (high - low < 2) continue;
    const std::vector<std::vector<Flat>> corners = CornersOf(layers, box, axis);
    Growing up(grid, axis), down(grid, axis);
    std::vector<std::int64_t> below;  // six times the volume of the hull below each plane
    for (int layer = low; layer + 1 < high; ++layer) {
      below.push_back(up.volume6());
      if (const auto& points = corners[static_cast<std::size_t>(layer - low)]; !points.empty())
        up.Include(layer, points);
    }
    below.push_back(up.volume6());
    const double gap = 6 * (layers.Spanned(axis) - static_cast<double>(cells)) / hull6;
    std::int64_t above = 0;  // the volume of the cells above the plane
    for (int layer = high - 1; layer > low; --layer) {
      if (const auto& points = corners[static_cast<std::size_t>(layer - low)]; !points.empty())
        down.Include(layer, points);
      above += layers.Volume(axis, layer);
      // Among equally good cuts prefer one across a gap, through a face, or near the middle: the first cut of
      // a ring makes no hull smaller.
      constexpr double kGap = 0.2, kFace = 0.1, kBalance = 0.05;
      const auto hulls = static_cast<double>(below[static_cast<std::size_t>(layer - low)] + down.volume6());
      const double uneven = std::abs(static_cast<double>(cells - 2 * above)) / static_cast<double>(cells);
      const double face = static_cast<double>(layers.Face(axis, layer)) / areas[axis];
      const double score = hulls / hull6 + kBalance * uneven - kFace * face - kGap * gap;
      if (cut.plane == 0 || score < best) {
        best = score;
        cut = {axis, layer};
      }
    }
  }
  return cut;
}

}  // namespace

std::optional<Piece> WholeOf(const CellGrid& grid) {
  return PieceIn(grid, {{0, 0, 0}, {grid.count(0), grid.count(1), grid.count(2)}});
}

std::pair<Piece, Piece> CutInTwo(const CellGrid& grid, const Piece& piece) {
  const BestCut cut = FindBestCut(grid, piece);
  CellBox low = piece.box, high = piece.box;
  low.high[cut.axis] = high.low[cut.axis] = cut.plane;
  // A piece's first and last layers are not empty, so both halves have cells.
  return {std::move(*PieceIn(grid, low)), std::move(*PieceIn(grid, high))};
}

}  // namespace coopdyn
