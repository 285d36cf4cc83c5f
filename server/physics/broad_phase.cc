// SPDX-License-Identifier: MIT
#include "server/physics/broad_phase.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/base/portable_math.h"
#include "server/physics/wheel_drive.h"

namespace coopdyn {

namespace {

// Circles larger than kLarge times the smallest do not determine the cells' width.
constexpr double kLarge = 4;
constexpr std::uint32_t kNoCell = std::numeric_limits<std::uint32_t>::max();

template <typename A, typename B>
bool Meet(const A& a, const B& b) {
  const double dx = a.x - b.x, dy = a.y - b.y, reach = a.radius_m + b.radius_m;
  return dx * dx + dy * dy <= reach * reach;
}

/// The cell number of a coordinate before wrapping; defined for any double.
std::int64_t CellNumber(double x) {
  constexpr double kFar = 1e15;
  return static_cast<std::int64_t>(std::floor(x > kFar ? kFar : x > -kFar ? x : -kFar));
}

constexpr double kCell_m = 0.5;
/// How much wider a robot may be than its disc when it leans, as long as its axis stays within 2°.
constexpr double kLean_m = 0.01;

/// Whether `part` overlaps `circle` in plan.
bool Reaches(const Circle& circle, const PlacedPart& part) {
  const double r = circle.radius_m;
  double dx = circle.x - part.p[0], dy = circle.y - part.p[1];
  const bool upright = std::abs(part.R[10]) > 1 - 1e-12;
  double half_x = part.half_m.x(), half_y = part.half_m.y();
  if (const Box* box = std::get_if<Box>(&part.part->shape)) {
    if (upright) {
      const double along = dx * part.R[0] + dy * part.R[4];
      dy = dx * part.R[1] + dy * part.R[5];
      dx = along;
      half_x = box->size_m.x() / 2;
      half_y = box->size_m.y() / 2;
    }
  } else if ((upright && !std::holds_alternative<Mesh>(part.part->shape)) ||
             std::holds_alternative<Sphere>(part.part->shape)) {
    const double reach = r + half_x;
    return dx * dx + dy * dy <= reach * reach;
  }
  const double out_x = std::max(0.0, std::abs(dx) - half_x), out_y = std::max(0.0, std::abs(dy) - half_y);
  return out_x * out_x + out_y * out_y <= r * r;
}

Aabb2 Around(const Circle& c) {
  return {c.x - c.radius_m, c.y - c.radius_m, c.x + c.radius_m, c.y + c.radius_m};
}

}  // namespace

void CircleGrid::Sort(std::span<const Circle> circles) {
  double smallest_m = std::numeric_limits<double>::infinity(), widest_m = 0;
  for (const Circle& c : circles) smallest_m = std::min(smallest_m, c.radius_m);
  small_m_ = kLarge * smallest_m;
  for (const Circle& c : circles) {
    if (c.radius_m <= small_m_) widest_m = std::max(widest_m, c.radius_m);
  }
  const double cells_per_m = 1 / std::max(2.001 * widest_m, 1e-3);  // slightly wider, for rounding
  // Two cells per circle, and at least four columns and rows, so that a cell's neighbours differ.
  columns_ = rows_ = 4;
  while (static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) < 2 * circles.size()) {
    (columns_ <= rows_ ? columns_ : rows_) *= 2;
  }
  large_.clear();
  cells_.resize(circles.size());
  starts_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const Circle& c = circles[i];
    if (!(c.radius_m <= small_m_)) {
      large_.push_back(static_cast<std::uint32_t>(i));
      cells_[i] = kNoCell;
      continue;
    }
    const std::int64_t column = CellNumber(c.x * cells_per_m) & (columns_ - 1);
    const std::int64_t row = CellNumber(c.y * cells_per_m) & (rows_ - 1);
    cells_[i] = static_cast<std::uint32_t>(row * columns_ + column);
    ++starts_[cells_[i] + 1];
  }
  for (std::size_t cell = 1; cell < starts_.size(); ++cell) starts_[cell] += starts_[cell - 1];
  items_.resize(starts_.back());
  // From the last circle backwards: turns each cell's end into its start.
  for (std::size_t i = circles.size(); i-- > 0;) {
    if (cells_[i] == kNoCell) continue;
    const Circle& c = circles[i];
    items_[--starts_[cells_[i] + 1]] = {c.x, c.y, c.radius_m, static_cast<std::uint32_t>(i)};
  }
  std::rotate(starts_.begin(), starts_.begin() + 1, starts_.end());
  starts_.back() = static_cast<std::uint32_t>(items_.size());
}

void CircleGrid::FindPairs(std::span<const Circle> circles, std::vector<Pair>& pairs) {
  pairs.clear();
  if (circles.size() < 2) return;
  Sort(circles);
  const auto add = [&pairs](std::uint32_t a, std::uint32_t b) {
    pairs.emplace_back(std::min(a, b), std::max(a, b));
  };
  // Each cell against itself and half of its neighbours.
  for (int row = 0; row < rows_; ++row) {
    const int next_row = ((row + 1) & (rows_ - 1)) * columns_;
    for (int column = 0; column < columns_; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                               static_cast<std::size_t>(column);
      const std::uint32_t first = starts_[cell], end = starts_[cell + 1];
      if (first == end) continue;
      const int right = (column + 1) & (columns_ - 1), left = (column - 1) & (columns_ - 1);
      const int neighbours[4] = {row * columns_ + right, next_row + left, next_row + column,
                                 next_row + right};
      for (std::uint32_t i = first; i < end; ++i) {
        const Item& a = items_[i];
        for (std::uint32_t j = i + 1; j < end; ++j) {
          if (Meet(a, items_[j])) add(a.index, items_[j].index);
        }
        for (const int neighbour : neighbours) {
          const std::size_t n = static_cast<std::size_t>(neighbour);
          for (std::uint32_t j = starts_[n]; j < starts_[n + 1]; ++j) {
            if (Meet(a, items_[j])) add(a.index, items_[j].index);
          }
        }
      }
    }
  }
  for (std::size_t k = 0; k < large_.size(); ++k) {
    const std::uint32_t a = large_[k];
    for (std::uint32_t b = 0; b < circles.size(); ++b) {
      const bool also_large = cells_[b] == kNoCell;
      if ((also_large && b <= a) || !Meet(circles[a], circles[b])) continue;
      add(a, b);
    }
  }
  std::sort(pairs.begin(), pairs.end());
}

/// The space of a robot with limbs, centred on its first body.
RobotSpace SpaceOfLimbs(const Mechanism& robot, const BodyState* bodies, double margin_m) {
  const Vector3& p = bodies[0].p_WB;
  RobotSpace space{{p.x(), p.y(), 0}, p.z(), p.z()};
  for (std::size_t k = 0; k < robot.bodies.size(); ++k) {
    const Vector3& q = bodies[k].p_WB;
    const double reach_m = robot.limb_radii_m[k] + margin_m;
    space.circle.radius_m =
        std::max(space.circle.radius_m, portable::Hypot(q.x() - p.x(), q.y() - p.y()) + reach_m);
    space.min_z = std::min(space.min_z, q.z() - reach_m);
    space.max_z = std::max(space.max_z, q.z() + reach_m);
  }
  return space;
}

RobotSpace SpaceOf(const Thing& thing, const BodyState& body, double margin_m) {
  const Mechanism& robot = *thing.mechanism;
  if (!robot.limb_radii_m.empty()) return SpaceOfLimbs(robot, &body, margin_m);
  const std::array<double, 9>& R = body.R_WB;
  const Vector3& p = thing.p_BR;
  const Vector3 p_WR = body.p_WB + Vector3(R[0] * p.x() + R[1] * p.y() + R[2] * p.z(),
                                           R[3] * p.x() + R[4] * p.y() + R[5] * p.z(),
                                           R[6] * p.x() + R[7] * p.y() + R[8] * p.z());
  const double rise = R[6] * thing.up_B.x() + R[7] * thing.up_B.y() + R[8] * thing.up_B.z();
  if (rise > 0.9995) {
    const double lean_m = rise > 1 - kRestTilt_rad * kRestTilt_rad ? 1e-4 : kLean_m;
    return {{p_WR.x(), p_WR.y(), robot.radius_m + margin_m + lean_m},
            p_WR.z() + robot.lowest_m - margin_m - lean_m,
            p_WR.z() + robot.height_m + margin_m + lean_m};
  }
  const double reach_m = robot.reach_m + margin_m;
  return {{p_WR.x(), p_WR.y(), reach_m}, p_WR.z() - reach_m, p_WR.z() + reach_m};
}

void BroadPhase::Objects::Add(const Actor& actor) {
  parts.push_back(actor.Place(0));
  boxes.emplace_back();
  Move(boxes.size() - 1, parts.back());
}

void BroadPhase::Objects::Move(std::size_t object, const PlacedPart& part) {
  const Vector3 half = part.half_m + Vector3::Constant(kAhead_m);
  parts[object] = part;
  boxes[object] = {part.p[0] - half.x(), part.p[1] - half.y(), part.p[0] + half.x(), part.p[1] + half.y()};
}

bool BroadPhase::Objects::OverlapsInHeight(std::size_t object, double min_z, double max_z) const {
  const PlacedPart& part = parts[object];
  const double half_m = part.half_m.z() + kAhead_m;
  return part.p[2] - half_m <= max_z && part.p[2] + half_m >= min_z;
}

BroadPhase::BroadPhase(const Things& things, std::span<const BodyState> bodies) : things_(things) {
  for (std::size_t i = 0; i < things.first_robot; ++i) objects_.Add(things.ActorOf(i, bodies));
  for (std::size_t i = things.first_static; i < things.all.size(); ++i) {
    statics_.Add(things.ActorOf(i, bodies));
  }
  objects_.grid.Build(objects_.boxes, kCell_m);
  statics_.grid.Build(statics_.boxes, kCell_m);
  spaces_.resize(things.first_static - things.first_robot);
}

void BroadPhase::MoveObject(std::size_t thing, const BodyState& body) {
  objects_.Move(thing, PlacedPart(*objects_.parts[thing].part, body));
  objects_moved_ = true;
}

void BroadPhase::FindNear(std::size_t thing, const Objects& objects, std::size_t first,
                          std::vector<Pair>& pairs) const {
  const RobotSpace& space = spaces_[thing - things_.first_robot];
  objects.grid.VisitOverlaps(objects.boxes, Around(space.circle), [&](std::uint32_t item) {
    if (!objects.OverlapsInHeight(item, space.min_z, space.max_z)) return true;
    if (!Reaches(space.circle, objects.parts[item])) return true;
    const std::uint32_t a = static_cast<std::uint32_t>(thing), b = static_cast<std::uint32_t>(first + item);
    pairs.emplace_back(std::min(a, b), std::max(a, b));
    return true;
  });
}

void BroadPhase::FindObjects(std::span<const std::uint8_t> moves) {
  if (objects_.boxes.empty()) return;
  if (objects_moved_) objects_.grid.Build(objects_.boxes, kCell_m);
  objects_moved_ = false;
  const std::size_t count = objects_.boxes.size();
  const auto among_objects = moves.first(count);
  if (std::find(among_objects.begin(), among_objects.end(), 1) != among_objects.end()) {
    objects_.grid.FindPairs(objects_.boxes, pairs_);
    std::erase_if(pairs_, [&](const Pair& pair) {
      const auto [a, b] = pair;
      const PlacedPart& part = objects_.parts[b];
      return (!moves[a] && !moves[b]) ||
             !objects_.OverlapsInHeight(a, part.p[2] - part.half_m.z(), part.p[2] + part.half_m.z());
    });
  }
  for (std::size_t thing = count; thing < moves.size(); ++thing) {
    const std::size_t first = pairs_.size();
    FindNear(thing, objects_, 0, pairs_);
    if (moves[thing] || pairs_.size() == first) continue;
    pairs_.erase(std::remove_if(pairs_.begin() + static_cast<std::ptrdiff_t>(first), pairs_.end(),
                                [&](const Pair& pair) { return !moves[pair.first]; }),
                 pairs_.end());
  }
}

void BroadPhase::FindStatics(std::span<const std::uint8_t> moves) {
  if (statics_.boxes.empty()) return;
  for (std::size_t thing = 0; thing < moves.size(); ++thing) {
    if (!moves[thing]) continue;
    const std::size_t first = pairs_.size();
    if (thing >= things_.first_robot) {
      FindNear(thing, statics_, things_.first_static, pairs_);
    } else {
      const PlacedPart& part = objects_.parts[thing];
      statics_.grid.VisitOverlaps(statics_.boxes, objects_.boxes[thing], [&](std::uint32_t item) {
        if (statics_.OverlapsInHeight(item, part.p[2] - part.half_m.z(), part.p[2] + part.half_m.z())) {
          pairs_.emplace_back(static_cast<std::uint32_t>(thing),
                              static_cast<std::uint32_t>(things_.first_static + item));
        }
        return true;
      });
    }
    std::sort(pairs_.begin() + static_cast<std::ptrdiff_t>(first), pairs_.end());
  }
}

void BroadPhase::FindIn(const Vector3& low_m, const Vector3& high_m,
                        std::vector<std::uint32_t>& found) const {
  const Aabb2 box{low_m.x(), low_m.y(), high_m.x(), high_m.y()};
  // The grid has the objects' places at the substep's start, so it cannot be used here.
  for (std::size_t i = 0; i < objects_.boxes.size(); ++i) {
    const Aabb2& of = objects_.boxes[i];
    if (of.min_x <= box.max_x && of.max_x >= box.min_x && of.min_y <= box.max_y && of.max_y >= box.min_y &&
        objects_.OverlapsInHeight(i, low_m.z(), high_m.z()))
      found.push_back(static_cast<std::uint32_t>(i));
  }
  for (std::size_t i = 0; i < spaces_.size(); ++i) {
    const auto& [circle, min_z, max_z] = spaces_[i];
    if (circle.x - circle.radius_m <= box.max_x && circle.x + circle.radius_m >= box.min_x &&
        circle.y - circle.radius_m <= box.max_y && circle.y + circle.radius_m >= box.min_y &&
        min_z <= high_m.z() && max_z >= low_m.z())
      found.push_back(static_cast<std::uint32_t>(things_.first_robot + i));
  }
  const std::size_t first = found.size();
  statics_.grid.VisitOverlaps(statics_.boxes, box, [&](std::uint32_t item) {
    if (statics_.OverlapsInHeight(item, low_m.z(), high_m.z()))
      found.push_back(static_cast<std::uint32_t>(things_.first_static + item));
    return true;
  });
  std::sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end());
}

const std::vector<BroadPhase::Pair>& BroadPhase::FindPairs(std::span<const std::uint8_t> moves) {
  pairs_.clear();
  FindObjects(moves);
  circles_.resize(spaces_.size());
  for (std::size_t i = 0; i < spaces_.size(); ++i) circles_[i] = spaces_[i].circle;
  robots_.FindPairs(circles_, robot_pairs_);
  const std::uint32_t base = static_cast<std::uint32_t>(things_.first_robot);
  for (const auto& [a, b] : robot_pairs_) {
    if (!moves[base + a] && !moves[base + b]) continue;
    const RobotSpace &space_a = spaces_[a], &space_b = spaces_[b];
    if (space_a.min_z > space_b.max_z || space_b.min_z > space_a.max_z) continue;
    pairs_.emplace_back(base + a, base + b);
  }
  std::sort(pairs_.begin(), pairs_.end());
  FindStatics(moves);
  return pairs_;
}

}  // namespace coopdyn
