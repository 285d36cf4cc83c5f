// SPDX-License-Identifier: MIT
#include "server/render/draw_list.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/geometry/mesh.h"
#include "server/render/joint_marks.h"
#include "server/render/palette.h"
#include "server/render/sensor_marks.h"

namespace coopdyn {

namespace {

constexpr double kSmall_px = 7, kLarge_px = 34;  // screen sizes at which the level of detail changes
constexpr double kTiny_px = 7;                   // a robot smaller than this is one cylinder
constexpr double kNameless_px = 9;               // below this a robot has no name

Rgba WithAlpha(const Color& color, double alpha) {
  return {color.r, color.g, color.b, alpha};
}

// A mobile robot whose chassis looks the same ahead and behind needs a mark that shows its heading.
bool NeedsHeadingMark(const RobotModel& model) {
  if (model.has_limbs()) return false;
  double sum_x_m = 0;
  for (const LinkShape& visual : model.links.front().visuals) sum_x_m += visual.X_LG.p.x();
  return std::abs(sum_x_m) <= 1e-3;
}

class Builder {
 public:
  Builder(const Frame& frame, const ImageRequest& request, const Camera& camera, Paint paint)
      : frame_(frame),
        request_(request),
        frustum_(camera, request.width, request.height),
        of_robot_(request.shot.has_value()),
        numbers_(paint == Paint::kNumbers),
        floor_marks_(frustum_) {}

  DrawList Build() {
    for (const SceneObject& object : frame_.scene->objects) {
      ++number_;
      texture_ = numbers_ ? nullptr : &object.object.texture;
      AddShape(object.object.shape, ObjectPose(frame_, object), object.object.color);
      texture_ = nullptr;
    }
    const int robots = static_cast<int>(frame_.scene->robots.size()), first = number_;
    number_ += robots;
    for (const Target& target : frame_.scene->targets) {
      ++number_;
      AddTarget(target);
    }
    for (int i = 0; i < robots; ++i) {
      number_ = first + i + 1;
      AddRobot(i);
    }
    std::stable_sort(labels_.begin(), labels_.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    for (auto& [depth_m, label] : labels_) list_.labels.push_back(std::move(label));
    list_.floor_marks = floor_marks_.Take();
    if (request_.show_rays && !of_robot_) list_.sensor_marks = SensorMarks(frame_, frustum_);
    if (request_.show_joints && !of_robot_) AddJoints();
    return std::move(list_);
  }

 private:
  void AddShape(const Shape& shape, const Pose& X_WG, const Color& color) {
    const double radius_m = BoundingRadius(shape);
    // The shadow may be in the picture even if the shape is not.
    const double shadow_m = std::max(X_WG.p.z() + radius_m, 0.0) * SunDirection().head<2>().norm();
    if (!frustum_.Sees(X_WG.p, radius_m + shadow_m)) return;
    const double size_px = radius_m * frustum_.PixelsPerMetre(X_WG.p);
    const int level = numbers_ || size_px >= kLarge_px ? 2 : size_px < kSmall_px ? 0 : 1;
    MeshId mesh = MeshId::kBox;
    Vector3 scale;
    if (const auto* box = std::get_if<Box>(&shape)) {
      scale = box->size_m;
    } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
      mesh = static_cast<MeshId>(static_cast<int>(MeshId::kCylinder8) + level);
      scale = {2 * cylinder->radius_m, 2 * cylinder->radius_m, cylinder->length_m};
    } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
      mesh = static_cast<MeshId>(static_cast<int>(MeshId::kSphere8) + level);
      scale = Vector3::Constant(2 * sphere->radius_m);
    } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
      AddShape(Cylinder{capsule->radius_m, capsule->length_m}, X_WG, color);
      for (const double end : {-0.5, 0.5}) {
        const Pose X_GE{{0, 0, end * capsule->length_m}, Quaternion::Identity()};
        AddShape(Sphere{capsule->radius_m}, X_WG * X_GE, color);
      }
      return;
    } else {
      const MeshData& data = *std::get<Mesh>(shape).data;
      const bool in_skin =
          data.skin != nullptr && data.color == std::array<double, 3>{color.r, color.g, color.b};
      InstancesOf(data, in_skin && !numbers_).push_back(MakeInstance(X_WG, Vector3::Ones(), Painted(color)));
      return;
    }
    const auto id = static_cast<std::size_t>(mesh);
    const bool is_clad = texture_ != nullptr && texture_->image != nullptr;
    (is_clad ? CladIn(*texture_).meshes[id] : list_.meshes[id])
        .push_back(MakeInstance(X_WG, scale, Painted(color)));
  }

  CladDraw& CladIn(const Texture& texture) {
    const auto found = std::ranges::find_if(list_.clad, [&texture](const CladDraw& one) {
      return one.texture.image == texture.image && one.texture.width_m == texture.width_m &&
             one.texture.height_m == texture.height_m;
    });
    return found != list_.clad.end() ? *found : list_.clad.emplace_back(CladDraw{texture, {}});
  }

  Color Painted(const Color& color) const {
    return numbers_ ? Color{static_cast<double>(number_), 0, 0} : of_robot_ ? color : ShownColor(color);
  }

  static MeshInstance MakeInstance(const Pose& X_WG, const Vector3& scale, const Color& color) {
    const Matrix3 axes = X_WG.q.normalized().toRotationMatrix();  // column-major: the axes in order
    return {ToFloats<9>(axes.data()), ToFloats<3>(scale.data()), ToFloats<3>(X_WG.p.data()),
            ToFloats<3>(&color.r)};
  }

  std::vector<MeshInstance>& InstancesOf(const MeshData& mesh, bool in_skin) {
    const auto found = std::ranges::find_if(
        list_.model_meshes, [&](const MeshDraw& one) { return one.mesh == &mesh && one.in_skin == in_skin; });
    return found != list_.model_meshes.end()
               ? found->instances
               : list_.model_meshes.emplace_back(MeshDraw{&mesh, in_skin, {}}).instances;
  }

  void AddTarget(const Target& target) {
    constexpr double kBall_m = 0.07, kPost_m = 0.018, kDisc_m = 0.22, kMinHeight_m = 0.5;
    if (!frustum_.Sees(target.p_WT, 1)) return;
    const Vector3 ball_W(target.p_WT.x(), target.p_WT.y(), std::max(target.p_WT.z(), kMinHeight_m));
    const Color post{0.35 * target.color.r + 0.3, 0.35 * target.color.g + 0.3, 0.35 * target.color.b + 0.3};
    AddShape(Cylinder{kPost_m, ball_W.z()},
             {{ball_W.x(), ball_W.y(), ball_W.z() / 2}, Quaternion::Identity()}, post);
    AddShape(Sphere{kBall_m}, {ball_W, Quaternion::Identity()}, target.color);
    if (of_robot_) return;  // a flag looks different from each side: cameras of robots see a ball on a post
    constexpr double kCloth_m = 0.30, kBreadth_m = 0.19, kThin_m = 0.008;
    const Pose X_WF{ball_W - Vector3(0, 0, kBall_m + kBreadth_m / 2), Quaternion::Identity()};
    AddShape(Box{{kCloth_m, kThin_m, kBreadth_m}}, X_WF * Pose{{kCloth_m / 2, 0, 0}, Quaternion::Identity()},
             target.color);
    floor_marks_.AddOnFloor(ball_W, kDisc_m, WithAlpha(ShownColor(target.color), 1), 2);
  }

  void AddRobot(int index) {
    const SceneRobot& robot = frame_.scene->robots[static_cast<std::size_t>(index)];
    const RobotModel& model = *robot.entry.model;
    const Pose X_WR = RobotPose(frame_, index);
    const double reach_m = std::hypot(model.footprint_radius_m, model.height_m);
    if (!frustum_.Sees(X_WR.p, 2 * reach_m)) return;
    if (!of_robot_) floor_marks_.AddOnFloor(X_WR.p, 1.45 * model.footprint_radius_m, {0, 0, 0, 0.5}, 1);
    const double size_px = reach_m * frustum_.PixelsPerMetre(X_WR.p);
    const Pose X_WTop = X_WR * Pose{{0, 0, model.height_m}, Quaternion::Identity()};
    if (of_robot_) return AddVisuals(index, robot);
    if (size_px < kTiny_px) {
      const Cylinder hull{0.8 * model.footprint_radius_m, model.height_m};
      AddShape(hull, X_WR * Pose{{0, 0, model.height_m / 2}, Quaternion::Identity()}, robot.entry.color);
    } else {
      AddVisuals(index, robot);
      if (NeedsHeadingMark(model)) {
        const double length_m = 0.6 * model.footprint_radius_m;
        AddShape(Box{{length_m, length_m / 4, 0.01}},
                 X_WTop * Pose{{length_m / 2, 0, 0.004}, Quaternion::Identity()}, {0.95, 0.95, 0.95});
      }
    }
    if (request_.show_names && size_px >= kNameless_px) AddLabel(robot, X_WTop.p);
  }

  void AddVisuals(int index, const SceneRobot& robot) {
    const std::vector<LinkModel>& links = robot.entry.model->links;
    for (std::size_t k = 0; k < links.size(); ++k) {
      const Pose X_WL = LinkPose(frame_, index, static_cast<int>(k));
      for (const LinkShape& visual : links[k].visuals) {
        AddShape(visual.shape, X_WL * visual.X_LG,
                 visual.takes_robot_color ? robot.entry.color : visual.color);
      }
    }
  }

  void AddJoints() {
    JointMarks marks = MarkJoints(frame_, frustum_);
    list_.joint_marks = std::move(marks.arrows);
    for (JointName& name : marks.names)
      list_.labels.push_back({std::move(name.text), name.x_px, name.y_px, name.color, name.at_px});
    for (JointName& name : marks.legend)
      list_.labels.push_back({std::move(name.text), name.x_px, name.y_px, name.color});
  }

  void AddLabel(const SceneRobot& robot, const Vector3& top_W) {
    const ProjectedPoint at = frustum_.Pixel(top_W + Vector3(0, 0, 0.06));
    if (at.depth_m < frustum_.near_m()) return;
    labels_.emplace_back(at.depth_m,
                         Label{robot.entry.name, at.x_px, at.y_px, ShownColor(robot.entry.color)});
  }

  const Frame& frame_;
  const ImageRequest& request_;
  const Frustum frustum_;
  const bool of_robot_;  // draws for a robot's camera
  const bool numbers_;
  const Texture* texture_ = nullptr;  // of the shapes being added
  int number_ = kFirstNumber - 1;     // segmentation number of the shapes being added
  DrawList list_;
  Overlay floor_marks_;
  std::vector<std::pair<double, Label>> labels_;  // with their depth
};

}  // namespace

DrawList MakeDrawList(const Frame& frame, const ImageRequest& request, const Camera& camera, Paint paint) {
  return Builder(frame, request, camera, paint).Build();
}

}  // namespace coopdyn
