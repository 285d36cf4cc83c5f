// SPDX-License-Identifier: MIT
#include "server/render/joint_marks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <utility>

#include "server/sensing/readings.h"

namespace coopdyn {

namespace {

using JointKind = JointModel::Kind;

struct TypeColor {
  JointKind kind;
  Color color;
};
constexpr TypeColor kTypeColors[] = {{JointKind::kHinge, {0.95, 0.42, 0.05}},
                                     {JointKind::kSlider, {0.1, 0.45, 0.95}},
                                     {JointKind::kScrew, {0.6, 0.25, 0.85}},
                                     {JointKind::kBall, {0.1, 0.62, 0.3}},
                                     {JointKind::kUniversal, {0.75, 0.65, 0.05}}};

Color ColorOf(JointKind kind) {
  return std::ranges::find(kTypeColors, kind, &TypeColor::kind)->color;
}

struct NamedJoint {
  JointName name;
  bool has_motor = false;
};

class JointMarker {
 public:
  JointMarker(const Frame& frame, const Frustum& frustum)
      : frame_(frame), frustum_(frustum), overlay_(frustum), scale_(frustum.height() / 720.0) {}

  JointMarks Mark() {
    for (std::size_t i = 0; i < frame_.scene->robots.size(); ++i) AddRobot(static_cast<int>(i));
    JointMarks marks;
    marks.names = Place();
    double x_px = 50 * scale_;
    for (const TypeColor& type : kTypeColors) {
      if (std::ranges::find(kinds_, type.kind) == kinds_.end()) continue;
      marks.legend.push_back(
          {std::string(ToString(type.kind)) + "s", x_px, frustum_.height() - 4.0, type.color, {}});
      x_px += 90 * scale_;
    }
    marks.arrows = overlay_.Take();
    return marks;
  }

 private:
  void AddRobot(int index) {
    const RobotModel& model = ModelOf(frame_, index);
    const double length_m = 0.08 * std::hypot(model.footprint_radius_m, model.height_m);
    for (std::size_t j = 0; j < model.joints.size(); ++j) {
      const JointModel& joint = model.joints[j];
      if (!joint.joins()) continue;
      const Pose X_RL = model.links[static_cast<std::size_t>(joint.child)].X_RL;
      const Pose X_WR = LinkPose(frame_, index, joint.child) * X_RL.Inverse();
      const Vector3 p_W = X_WR * joint.p_RJ;
      const ProjectedPoint at = frustum_.Pixel(p_W);
      if (at.depth_m < frustum_.near_m()) continue;
      const Color color = ColorOf(joint.kind);
      kinds_.push_back(joint.kind);
      AddAxis(p_W, X_WR.q * joint.axis_R.normalized() * length_m, joint, color);
      std::string name = joint.name;  // the font has only ASCII
      std::ranges::replace_if(
          name, [](char c) { return c < ' ' || c > '~'; }, '?');
      named_.push_back(
          {{std::move(name), 0, 0, color, {at.x_px, at.y_px}}, model.IsDriven(static_cast<int>(j))});
    }
  }

  void AddAxis(const Vector3& p_W, const Vector3& axis_W, const JointModel& joint, const Color& color) {
    const Rgba ink{color.r, color.g, color.b, 0.95}, rim{1, 1, 1, 0.8};
    if (joint.has_axis()) {
      const double pixel_m = scale_ / frustum_.PixelsPerMetre(p_W);
      const Vector3 along = axis_W.normalized(), tip_W = p_W + axis_W;
      const Vector3 across = along.cross(frustum_.eye_W() - p_W).stableNormalized() * (5 * pixel_m);
      overlay_.AddLine(p_W - 0.5 * axis_W, tip_W, 5 * scale_, rim);
      overlay_.AddLine(p_W - 0.5 * axis_W, tip_W, 2.5 * scale_, ink);
      overlay_.AddTriangle(tip_W + across, tip_W - across, tip_W + along * (12 * pixel_m), ink);
      if (joint.kind != JointKind::kSlider) AddRing(p_W, along, 0.35 * axis_W.norm(), ink);
    }
    overlay_.AddDot(p_W, (joint.has_axis() ? 3.5 : 6) * scale_, ink);
  }

  void AddRing(const Vector3& p_W, const Vector3& along, double radius_m, const Rgba& ink) {
    const Vector3 u = along.unitOrthogonal() * radius_m, v = along.cross(u);
    constexpr int kParts = 20;
    const auto point = [&](int i) -> Vector3 {
      const double angle = 2 * std::numbers::pi * i / kParts;
      return p_W + std::cos(angle) * u + std::sin(angle) * v;
    };
    for (int i = 0; i < kParts; ++i) overlay_.AddLine(point(i), point(i + 1), 1.5 * scale_, ink);
  }

  /// Stacks the names of one side, each as near to its joint as the other names allow.
  void Stack(std::span<NamedJoint> side, double x_px, double step_px) const {
    std::ranges::sort(side, {}, [](const NamedJoint& one) { return one.name.at_px[1]; });
    double next_px = step_px;
    for (NamedJoint& one : side) {
      one.name.x_px = x_px;
      one.name.y_px = std::max(one.name.at_px[1] + step_px / 2, next_px);
      next_px = one.name.y_px + step_px;
    }
    double most_px = frustum_.height() - 1.5 * step_px;
    for (std::size_t i = side.size(); i-- > 0; most_px -= step_px)
      side[i].name.y_px = std::min(side[i].name.y_px, most_px);
  }

  std::vector<JointName> Place() {
    const double step_px = 29 * scale_, half_px = 95 * scale_;
    const auto rows = static_cast<std::size_t>(std::max(frustum_.height() / step_px - 2.5, 0.0));
    std::ranges::stable_sort(named_, std::greater(), &NamedJoint::has_motor);
    if (named_.size() > 2 * rows) named_.resize(2 * rows);
    if (named_.empty()) return {};
    std::ranges::sort(named_, {}, [](const NamedJoint& one) { return one.name.at_px[0]; });
    const double away_px = 190 * scale_;
    const double left_px = named_.front().name.at_px[0] - away_px,
                 right_px = named_.back().name.at_px[0] + away_px;
    const std::span<NamedJoint> all(named_);
    const std::size_t half = named_.size() / 2;
    Stack(all.first(half), std::max(left_px, half_px), step_px);
    Stack(all.subspan(half), std::min(right_px, frustum_.width() - half_px), step_px);
    std::vector<JointName> names;
    for (NamedJoint& one : named_) names.push_back(std::move(one.name));
    return names;
  }

  const Frame& frame_;
  const Frustum& frustum_;
  Overlay overlay_;
  const double scale_;
  std::vector<JointKind> kinds_;
  std::vector<NamedJoint> named_;
};

}  // namespace

JointMarks MarkJoints(const Frame& frame, const Frustum& frustum) {
  return JointMarker(frame, frustum).Mark();
}

}  // namespace coopdyn
