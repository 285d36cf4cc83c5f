// SPDX-License-Identifier: MIT
// What moves without contacts keeps its energy and its momentum, at 1, 5 and 10 ms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "tests/server/physics/rig.h"

namespace coopdyn {
namespace {

class FreeMotionTest : public ::testing::TestWithParam<int> {
 protected:
  void Add(RobotModel model) { BuildWith(std::move(model), GetParam(), scene_); }

  double Energy_j(double gravity_m_s2 = kG) {
    const auto frame = scene_.Capture();
    double sum_j = 0;
    for (std::size_t i = 0; i < frame->bodies.size(); ++i) {
      const LinkModel& link = scene_.robot_model->links[i];
      const BodyState& body = frame->bodies[i];
      const Vector3 w_B = body.orientation().conjugate() * body.w_WB;
      sum_j += link.mass_kg * (gravity_m_s2 * body.p_WB.z() + body.v_WB.squaredNorm() / 2) +
               w_B.dot(link.inertia_kg_m2.cwiseProduct(w_B)) / 2;
    }
    return sum_j;
  }

  /// The most by which the energy, as the mean of a second, leaves that of the start.
  double Drift_j(int duration_s, double gravity_m_s2 = kG) {
    const double before_j = Energy_j(gravity_m_s2);
    double worst_j = 0;
    for (int second = 0; second < duration_s; ++second) {
      double sum_j = 0;
      const int steps = 1000 / GetParam();
      for (int i = 0; i < steps; ++i) {
        scene_.Run(1);
        sum_j += Energy_j(gravity_m_s2);
      }
      worst_j = std::max(worst_j, std::abs(sum_j / steps - before_j));
    }
    return worst_j;
  }

  PhysicsScene scene_;
};

/// `links` of together 2.4 m and 1.2 kg that hang on each other, level.
RobotModel Chain(int links) {
  RobotModel model = OnAPost();
  const double length_m = 2.4 / links, mass_kg = 1.2 / links;
  for (int i = 0; i < links; ++i) {
    const std::string name = "link" + std::to_string(i);
    model.links.push_back(
        Link(name, {(i + 0.5) * length_m, 0, 3}, mass_kg, mass_kg * length_m * length_m / 12));
    model.links.back().collisions.clear();
    model.joints.push_back(Hinge(name, i, i + 1, {i * length_m, 0, 3}));
  }
  return model;
}

TEST_P(FreeMotionTest, ADoublePendulumKeepsItsEnergy) {
  Add(Chain(2));
  EXPECT_LT(Drift_j(30) / (1.2 * kG * 1.2), 2e-3 * GetParam());
}

/// Its whips last a few milliseconds.
class LimpChainTest : public FreeMotionTest {};

TEST_P(LimpChainTest, ItKeepsItsEnergy) {
  for (const int links : {3, 6}) {
    scene_ = PhysicsScene();
    Add(Chain(links));
    EXPECT_LT(Drift_j(60) / (1.2 * kG * 1.2), 0.05) << links;
  }
}

TEST_P(FreeMotionTest, ATumblingRobotKeepsItsEnergy) {
  RobotModel model = OnAPost();
  model.fixed_base = false;
  model.links[0].inertia_kg_m2 = {0.01, 0.02, 0.03};
  model.links.push_back(Link("arm", {0.3, 0, 3.1}, 0.5, 0.004));
  model.links.push_back(Link("hand", {0.3, 0.2, 3.1}, 0.2, 0.001));
  model.joints = {Hinge("shoulder", 0, 1, {0.1, 0, 3}), Hinge("wrist", 1, 2, {0.3, 0.1, 3.1})};
  model.joints[1].axis_R = Vector3::UnitX();
  for (int link = 1; link < 3; ++link) model.links[static_cast<std::size_t>(link)].collisions.clear();
  scene_.SetGravity(0);
  Add(model);
  auto frame = scene_.Capture();
  const Vector3 w_W(3, 18, 8),
      centre_W = (Vector3(0, 0, 3) + 0.5 * Vector3(0.3, 0, 3.1) + 0.2 * Vector3(0.3, 0.2, 3.1)) / 1.7;
  for (BodyState& body : frame->bodies) {
    body.w_WB = w_W;
    body.v_WB = w_W.cross(body.p_WB - centre_W);
  }
  scene_.Restore(*frame);
  const double energy_j = Energy_j(0);
  EXPECT_LT(Drift_j(30, 0) / energy_j, 0.03 * GetParam());
}

TEST_P(FreeMotionTest, ASpringKeepsItsAmplitude) {
  RobotModel model = OnAPost();
  model.links.push_back(Link("carriage", {0, 0, 3}, 2, 0.01));
  JointModel rail = Hinge("rail", 0, 1, {0, 0, 3});
  rail.kind = JointModel::Kind::kSlider;
  rail.axis_R = Vector3::UnitX();
  rail.stiffness = 2 * std::pow(2 * std::numbers::pi, 2);  // 1 Hz
  rail.rest = 0.1;
  model.joints = {rail};
  Add(model);
  scene_.RunFor(19.5);
  double least_m = 1, most_m = -1;
  for (int i = 0; i < 1000 / GetParam(); ++i) {
    scene_.Run(1);
    const double x_m = LinkPose(*scene_.Capture(), 0, 1).p.x();
    least_m = std::min(least_m, x_m);
    most_m = std::max(most_m, x_m);
  }
  EXPECT_NEAR(least_m, 0, 1e-3);
  EXPECT_NEAR(most_m, 0.2, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(SmallSteps, LimpChainTest, ::testing::Values(1));
INSTANTIATE_TEST_SUITE_P(Steps, FreeMotionTest, ::testing::Values(1, 5, 10),
                         [](const auto& step) { return std::to_string(step.param) + "ms"; });

}  // namespace
}  // namespace coopdyn
