// SPDX-License-Identifier: MIT
// Merges links that fixed joints hold together into one link of the robot.
#include <Eigen/Dense>
#include <algorithm>
#include <optional>
#include <utility>

#include "server/model/sdf_parts.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// Adds the mass and the shapes of `from` to `to`.
void Merge(const LinkModel& from, LinkModel& to) {
  const Pose X_TF = to.X_RL.Inverse() * from.X_RL;
  const auto add = [&X_TF](const std::vector<LinkShape>& shapes, std::vector<LinkShape>& all) {
    for (const LinkShape& shape : shapes) {
      all.push_back(shape);
      all.back().X_LG = X_TF * shape.X_LG;
    }
  };
  add(from.collisions, to.collisions);
  add(from.visuals, to.visuals);
  if (from.mass_kg <= 0) return;
  AddMass(from.mass_kg, from.inertia_kg_m2, X_TF * from.X_LI, to);
}

class Welder {
 public:
  Welder(ModelLines lines, std::vector<std::pair<int, int>> ties, const std::string& file, RobotModel& robot,
         bool foreign, Diagnostics& diagnostics)
      : lines_(std::move(lines)),
        ties_(std::move(ties)),
        file_(file),
        foreign_(foreign),
        robot_(robot),
        diagnostics_(diagnostics) {}

  void Weld(std::span<const FixedJoint> fixed) {
    const std::vector<int> holders = Holders(fixed);
    std::vector<int> roots;
    std::optional<int> base;
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      const std::optional<int> root = RootOf(static_cast<int>(i), holders);
      if (!root)
        return Error(lines_.links[i], Link(i) + " hangs in a loop of fixed joints: remove one of them");
      roots.push_back(*root);
      if (holders[Index(*root)] != FixedJoint::kWorld) continue;
      if (base && *base != *root) {
        return Error(lines_.links[i], Link(Index(*base)) + " and " + Link(Index(*root)) +
                                          " are both fixed to the world: fix one to the other");
      }
      base = *root;
    }
    robot_.fixed_base = base.has_value();
    for (std::size_t i = 0; i < roots.size(); ++i) {
      robot_.frames.push_back({robot_.links[i].name, roots[i], robot_.links[i].X_RL});
    }
    for (std::size_t i = 0; i < roots.size(); ++i) {
      if (roots[i] != static_cast<int>(i)) Merge(robot_.links[i], robot_.links[Index(roots[i])]);
    }
    Renumber(roots);
    Keep(roots, base.value_or(FirstThatIsNoChild(roots)));
    CheckJoints();
  }

 private:
  static constexpr int kNobody = -2;
  static std::size_t Index(int link) { return static_cast<std::size_t>(link); }
  std::string Link(std::size_t link) const { return "link '" + robot_.links[link].name + "'"; }
  void Error(int line, std::string text) { diagnostics_.Error({file_, line}, std::move(text)); }

  /// For each link, the parent of its fixed joint.
  std::vector<int> Holders(std::span<const FixedJoint> fixed) {
    std::vector<int> holders(robot_.links.size(), kNobody);
    for (const FixedJoint& joint : fixed) {
      int& holder = holders[Index(joint.child)];
      if (holder != kNobody)
        Error(joint.line, Link(Index(joint.child)) + " is the child of two fixed joints");
      holder = joint.parent;
    }
    return holders;
  }

  /// The link into which `link` is merged; nullopt in a loop.
  static std::optional<int> RootOf(int link, const std::vector<int>& holders) {
    for (std::size_t steps = 0; steps <= holders.size(); ++steps) {
      const int holder = holders[Index(link)];
      if (holder < 0) return link;
      link = holder;
    }
    return std::nullopt;
  }

  int FirstThatIsNoChild(const std::vector<int>& roots) const {
    const auto is_child = [this](int link) {
      return std::ranges::find(robot_.joints, link, &JointModel::child) != robot_.joints.end();
    };
    const auto found = std::ranges::find_if_not(roots, is_child);
    return found == roots.end() ? roots.front() : *found;
  }

  void Renumber(const std::vector<int>& numbers) {
    for (JointModel& joint : robot_.joints) {
      joint.parent = numbers[Index(joint.parent)];
      joint.child = numbers[Index(joint.child)];
    }
    for (FrameModel& frame : robot_.frames) frame.link = numbers[Index(frame.link)];
    for (auto& [from, to] : ties_) {
      from = numbers[Index(from)];
      to = numbers[Index(to)];
    }
  }

  /// Keeps only root links, the base first.
  void Keep(const std::vector<int>& roots, int base) {
    std::vector<LinkModel> kept;
    std::vector<int> lines, numbers(roots.size());
    const auto keep = [&](int link) {
      numbers[Index(link)] = static_cast<int>(kept.size());
      kept.push_back(std::move(robot_.links[Index(link)]));
      lines.push_back(lines_.links[Index(link)]);
    };
    keep(base);
    for (int i = 0; i < static_cast<int>(roots.size()); ++i) {
      if (roots[Index(i)] == i && i != base) keep(i);
    }
    robot_.links = std::move(kept);
    lines_.links = std::move(lines);
    Renumber(numbers);
  }

  /// Checks that joints or ties connect every link to the first one.
  void CheckJoints() {
    std::vector<std::uint8_t> reached(robot_.links.size());
    reached[0] = 1;
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      const JointModel& joint = robot_.joints[i];
      if (joint.parent != joint.child) continue;
      Error(lines_.joints[i], "joint '" + joint.name + "' joins links that fixed joints hold together");
    }
    for (std::size_t round = 0; round < robot_.joints.size() + ties_.size(); ++round) {
      for (const JointModel& joint : robot_.joints) {
        std::uint8_t& parent = reached[Index(joint.parent)];
        std::uint8_t& child = reached[Index(joint.child)];
        parent = child = parent | child;
      }
      for (const auto& [from, to] : ties_) {
        reached[Index(from)] = reached[Index(to)] = reached[Index(from)] | reached[Index(to)];
      }
    }
    std::vector<std::string> loose;
    int first_line = 0;
    for (std::size_t i = 1; i < reached.size(); ++i) {
      if (reached[i] != 0) continue;
      if (!foreign_) Error(lines_.links[i], Link(i) + " hangs on no joint that leads to " + Link(0));
      if (loose.empty()) first_line = lines_.links[i];
      loose.push_back("'" + robot_.links[i].name + "'");
    }
    if (!foreign_ || loose.empty()) return;
    robot_.has_loose = true;
    diagnostics_.Mended({file_, first_line},
                        "no joint leads from " + Link(0) + " to " + JoinNames(loose) +
                            ": they move on their own, and the robot's pose is that of " + Link(0));
  }

  ModelLines lines_;                       // of the robot's links and joints
  std::vector<std::pair<int, int>> ties_;  // links connected by muscles
  const std::string& file_;
  const bool foreign_;
  RobotModel& robot_;
  Diagnostics& diagnostics_;
};

}  // namespace

void AddMass(double added_kg, const Vector3& inertia_kg_m2, const Pose& X_LI, LinkModel& to) {
  const double mass_kg = to.mass_kg + added_kg;
  const Vector3 p = (to.mass_kg * to.X_LI.p + added_kg * X_LI.p) / mass_kg;
  const auto about = [&p](double part_kg, const Vector3& inertia, const Pose& X) -> Matrix3 {
    const Matrix3 R = X.q.toRotationMatrix();
    const Vector3 d = X.p - p;
    return R * inertia.asDiagonal() * R.transpose() +
           part_kg * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
  };
  const Vector3 own = to.mass_kg > 0 ? to.inertia_kg_m2 : Vector3::Zero();
  const Eigen::SelfAdjointEigenSolver<Matrix3> moments(about(to.mass_kg, own, to.X_LI) +
                                                       about(added_kg, inertia_kg_m2, X_LI));
  Matrix3 axes = moments.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  to.mass_kg = mass_kg;
  to.X_LI = {p, Quaternion(axes).normalized()};
  to.inertia_kg_m2 = moments.eigenvalues();
}

void WeldLinks(std::span<const FixedJoint> fixed, std::vector<std::pair<int, int>> ties,
               const ModelLines& lines, const std::string& file, RobotModel& robot, bool foreign,
               Diagnostics& diagnostics) {
  if (robot.links.empty()) return;
  Welder(lines, std::move(ties), file, robot, foreign, diagnostics).Weld(fixed);
}

}  // namespace coopdyn
