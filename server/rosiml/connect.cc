// SPDX-License-Identifier: MIT
#include "server/rosiml/connect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/base/portable_math.h"
#include "server/base/printable.h"
#include "server/rosiml/lines.h"

namespace coopdyn::rosiml {

namespace {

constexpr double kTiny = 1e-7;  // tolerance of lengths (m) and of unit vectors

std::size_t Index(int i) {
  return static_cast<std::size_t>(i);
}

class Connector {
 public:
  Connector(const Movable& movable, const std::string& file, Diagnostics& diagnostics)
      : movable_(movable),
        file_(file),
        diagnostics_(diagnostics),
        is_reached_(movable.bodies.size()),
        is_used_(movable.joints.size()) {}

  std::vector<Model> Connect() {
    const int count = static_cast<int>(movable_.bodies.size());
    for (std::size_t j = 0; j < movable_.joints.size(); ++j) {
      for (const int end : {movable_.joints[j].source, movable_.joints[j].destination}) {
        if (end != Joint::kWorld) joints_of_[Index(end)].push_back(j);
      }
    }
    std::vector<Model> models;
    for (int body = 0; body < count; ++body) {
      if (!is_reached_[Index(body)]) models.push_back(ModelOf(body));
    }
    return models;
  }

 private:
  bool IsStill(int body) const { return movable_.bodies[Index(body)].mass_kg <= 0; }

  /// The bodies connected to `first` by joints and muscles, in file order.
  std::vector<int> Together(int first) {
    std::vector<int> found = {first};
    std::vector<bool> seen(movable_.bodies.size());
    seen[Index(first)] = true;
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (const std::size_t j : joints_of_[Index(found[i])]) {
        for (const int end : {movable_.joints[j].source, movable_.joints[j].destination}) {
          if (end == Joint::kWorld || seen[Index(end)]) continue;
          seen[Index(end)] = true;
          found.push_back(end);
        }
      }
      for (const Muscle& muscle : movable_.muscles) {
        if (muscle.source != found[i] && muscle.destination != found[i]) continue;
        const int end = muscle.source == found[i] ? muscle.destination : muscle.source;
        if (seen[Index(end)]) continue;
        seen[Index(end)] = true;
        found.push_back(end);
      }
    }
    std::ranges::sort(found);
    return found;
  }

  Model ModelOf(int first) {
    const std::vector<int> bodies = Together(first);
    Model model;
    std::ranges::copy_if(bodies, std::back_inserter(model.still), [this](int body) { return IsStill(body); });
    std::vector<int> roots = model.still;
    for (const int body : bodies) {
      if (!IsStill(body) && BindToWorld(body, model)) roots.push_back(body);
    }
    const bool is_fixed = !roots.empty();
    std::optional<Pose> X_WR;
    if (!is_fixed) X_WR = FindDrive(bodies, roots);
    if (roots.empty()) roots.push_back(first);
    Walk(roots, model);
    for (const int body : bodies) {
      if (!is_reached_[Index(body)]) Walk({body}, model);  // only a muscle connects it
    }
    if (X_WR) {
      OrderWheels(*X_WR, model);
      model.X_WR = *X_WR;
    } else {
      model.X_WR = FrameOf(model, is_fixed);
    }
    Lift(model, is_fixed);
    MarkBase(model);
    return model;
  }

  /// Links `body` to the world by its joints with the world. False if it has none.
  bool BindToWorld(int body, Model& model) {
    bool is_bound = false;
    for (const std::size_t j : joints_of_[Index(body)]) {
      if (movable_.joints[j].destination != Joint::kWorld || is_used_[j]) continue;
      is_used_[j] = true;
      is_bound = true;
      model.links.push_back({static_cast<int>(j), Joint::kWorld, body, !movable_.joints[j].counts_source});
    }
    return is_bound;
  }

  /// Adds the bodies and joints that are reachable from `roots`, directing each joint away from them.
  void Walk(const std::vector<int>& roots, Model& model) {
    std::size_t i = model.bodies.size();
    model.bodies.insert(model.bodies.end(), roots.begin(), roots.end());
    for (const int root : roots) is_reached_[Index(root)] = true;
    for (; i < model.bodies.size(); ++i) {
      const int parent = model.bodies[i];
      for (const std::size_t j : joints_of_[Index(parent)]) {
        if (is_used_[j]) continue;
        is_used_[j] = true;
        const Joint& joint = movable_.joints[j];
        if (joint.destination == Joint::kWorld) continue;  // the body is already fixed
        const int child = joint.source == parent ? joint.destination : joint.source;
        const bool child_is_source = joint.source == child;
        model.links.push_back({static_cast<int>(j), parent, child, child_is_source != joint.counts_source});
        if (!is_reached_[Index(child)]) model.bodies.push_back(child);
        is_reached_[Index(child)] = true;
      }
    }
  }

  /// The wheel radius of `body` on `joint`; 0 if it is not a wheel.
  double WheelRadius(const Body& body, const Joint& joint) const {
    if (body.parts.size() != 1) return 0;
    const Pose X_WG = body.X_WB * body.parts.front().X_BG;
    const Vector3 axis = joint.X_WJ.q * Vector3::UnitX();
    const Vector3 off = X_WG.p - joint.X_WJ.p;
    if ((off - off.dot(axis) * axis).norm() > kTiny || std::abs(axis.z()) > kTiny) return 0;
    if (const auto* sphere = std::get_if<Sphere>(&body.parts.front().shape)) return sphere->radius_m;
    const auto* cylinder = std::get_if<Cylinder>(&body.parts.front().shape);
    const bool along = std::abs((X_WG.q * Vector3::UnitZ()).dot(axis)) > 1 - 1e-12;
    return cylinder != nullptr && along ? cylinder->radius_m : 0;
  }

  /// Returns the frame of a robot with a two-wheel drive and makes its base the only root. Returns nullopt if
  /// the robot has no such drive.
  std::optional<Pose> FindDrive(const std::vector<int>& bodies, std::vector<int>& roots) {
    std::vector<std::size_t> wheels;
    for (std::size_t j = 0; j < movable_.joints.size(); ++j) {
      const Joint& joint = movable_.joints[j];
      if (joint.is_driven && joint.is_wheel && joint.kind == Joint::Kind::kHinge && !joint.limit &&
          std::ranges::binary_search(bodies, joint.source))
        wheels.push_back(j);
    }
    if (wheels.size() != 2) return std::nullopt;
    const Joint &a = movable_.joints[wheels[0]], &b = movable_.joints[wheels[1]];
    for (const int base : {a.source, a.destination}) {
      if (base != b.source && base != b.destination) continue;
      const int left = a.source == base ? a.destination : a.source;
      const int right = b.source == base ? b.destination : b.source;
      if (left == right || joints_of_[Index(left)].size() != 1 || joints_of_[Index(right)].size() != 1)
        continue;
      const Body &left_body = movable_.bodies[Index(left)], &right_body = movable_.bodies[Index(right)];
      const double radius_m = WheelRadius(left_body, a);
      if (radius_m <= 0 || std::abs(WheelRadius(right_body, b) - radius_m) > kTiny) continue;
      const Vector3 p_left = CentreOf(left_body), p_right = CentreOf(right_body), way = p_left - p_right;
      // A positive speed must drive forward: the axis, with the first joint's sign, points left.
      const bool is_along = (left == a.source) == a.counts_source;
      const Vector3 y = (is_along ? 1 : -1) * (a.X_WJ.q * Vector3::UnitX());
      if (way.norm() < 1e-3 || (way - way.dot(y) * y).norm() > kTiny) continue;
      const Vector3 b_axis = b.X_WJ.q * Vector3::UnitX();
      if (b_axis.cross(y).norm() > kTiny) continue;
      Vector3 p = (p_left + p_right) / 2;
      p.z() -= radius_m;
      if (p.z() > Lowest(bodies) + kTiny) continue;  // the robot does not stand on its wheels
      roots = {base};
      wheels_ = wheels;
      return Pose{p, FromRollPitchYaw(0, 0, portable::Atan2(-y.x(), y.y()))};
    }
    return std::nullopt;
  }

  Vector3 CentreOf(const Body& body) const { return (body.X_WB * body.parts.front().X_BG).p; }

  void OrderWheels(const Pose& X_WR, Model& model) {
    std::array<int, 2> found{};
    std::array<double, 2> y{};
    for (std::size_t i = 0; i < 2; ++i) {
      const auto link = std::ranges::find(model.links, static_cast<int>(wheels_[i]), &Model::Link::joint);
      found[i] = static_cast<int>(link - model.links.begin());
      const Body& wheel = movable_.bodies[Index(link->child)];
      y[i] = (X_WR.Inverse() * CentreOf(wheel)).y();
      // Both wheels' axes point left.
      const Vector3 axis = movable_.joints[wheels_[i]].X_WJ.q * Vector3::UnitX();
      link->is_turned = axis.dot(X_WR.q * Vector3::UnitY()) < 0;
    }
    if (y[0] < y[1]) std::swap(found[0], found[1]);
    model.wheels = found;
  }

  /// The lowest z of the shapes of `bodies`, without meshes; 0 if there are none.
  double Lowest(const std::vector<int>& bodies) const {
    double low = std::numeric_limits<double>::infinity();
    for (const int body : bodies) {
      const Body& one = movable_.bodies[Index(body)];
      for (const Part& part : one.parts) {
        const Pose X_WG = one.X_WB * part.X_BG;
        const double half =
            std::holds_alternative<Mesh>(part.shape) ? 0 : HalfExtents(part.shape, X_WG.q).z();
        low = std::min(low, X_WG.p.z() - half);
      }
    }
    return std::isfinite(low) ? low : 0;
  }

  bool HasMesh(const std::vector<int>& bodies) const {
    return std::ranges::any_of(bodies, [this](int body) {
      return std::ranges::any_of(movable_.bodies[Index(body)].parts,
                                 [](const Part& part) { return !part.mesh_file.empty(); });
    });
  }

  /// The model's frame: below its base, with the heading of the robot or, if it is not a robot, of the base.
  Pose FrameOf(const Model& model, bool is_fixed) const {
    const Body& base = movable_.bodies[Index(model.bodies.front())];
    const double heading = Heading(movable_.is_robot ? movable_.X_WM.q : base.X_WB.q);
    Vector3 p = base.X_WB.p;
    // A mesh's extent is unknown until its file is read: do not move the model.
    p.z() = is_fixed || HasMesh(model.bodies) ? 0 : Lowest(model.bodies);
    return {p, FromRollPitchYaw(0, 0, heading)};
  }

  void Lift(Model& model, bool is_fixed) {
    constexpr double kLittle_m = 1e-6;
    if (is_fixed || model.X_WR.p.z() >= 0) return;
    if (model.X_WR.p.z() < -kLittle_m) {
      diagnostics_.Warning({file_, movable_.line}, "'" + Printable(movable_.name) + "' stands " +
                                                       Exact(std::round(-model.X_WR.p.z() * 1e6) / 1e3) +
                                                       " mm in the ground: it is lifted onto the ground");
    }
    model.lift_m = -model.X_WR.p.z();
  }

  void MarkBase(Model& model) const {
    model.is_base.assign(movable_.bodies.size(), false);
    model.is_base[Index(model.bodies.front())] = true;
    for (const int body : model.still) model.is_base[Index(body)] = true;
    for (const Model::Link& link : model.links) {
      if (movable_.joints[Index(link.joint)].kind != Joint::Kind::kFixed) continue;
      const bool parent = link.parent == Joint::kWorld || model.is_base[Index(link.parent)];
      if (parent) model.is_base[Index(link.child)] = true;
    }
  }

  const Movable& movable_;
  const std::string& file_;
  Diagnostics& diagnostics_;
  std::vector<std::uint8_t> is_reached_;  // for each body
  std::vector<std::uint8_t> is_used_;     // for each joint
  std::vector<std::vector<std::size_t>> joints_of_{movable_.bodies.size()};
  std::vector<std::size_t> wheels_;  // the joints of the drive
};

}  // namespace

std::vector<Model> Connect(const Movable& movable, const std::string& file, Diagnostics& diagnostics) {
  return Connector(movable, file, diagnostics).Connect();
}

}  // namespace coopdyn::rosiml
