// SPDX-License-Identifier: MIT
// Bodies without contacts keep their energy and momentum, at 1, 5 and 10 ms.
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

constexpr double kOneHertz_rad_s = 2 * std::numbers::pi;

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

  /// The greatest deviation of the energy, averaged over a second, from that at the start.
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

  /// Minimum and maximum of `measure` in the steps of a second.
  template <typename Measure>
  std::pair<double, double> Range(const Measure& measure) {
    double least = 1, most = -1;
    for (int i = 0; i < 1000 / GetParam(); ++i) {
      scene_.Run(1);
      const double value = measure();
      least = std::min(least, value);
      most = std::max(most, value);
    }
    return {least, most};
  }

  PhysicsScene scene_;
};

/// A horizontal chain of `links` with a total of 2.4 m and 1.2 kg.
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

TEST_P(FreeMotionTest, LimpChainsKeepTheirEnergy) {
  for (const auto& [links, duration_s] : {std::pair(2, 60), {3, 60}, {6, 60}, {12, 60}, {50, 10}}) {
    scene_ = PhysicsScene();
    Add(Chain(links));
    EXPECT_LT(Drift_j(duration_s) / (1.2 * kG * 1.2), 1e-3) << links;
  }
}

TEST_P(FreeMotionTest, ALimpChainFallsAsItDoesInSmallSteps) {
  Add(Chain(12));
  scene_.RunFor(1);
  const Vector3 tip_W = LinkPose(*scene_.Capture(), 0, 12).p;
  EXPECT_LT((tip_W - Vector3(-1.801, 0, 1.676)).norm(), 0.01 * GetParam());  // from short steps
}

TEST_P(FreeMotionTest, AGyroscopePrecessesAtItsRate) {
  RobotModel model = OnAPost();
  model.links.push_back(Link("disc", {0.1, 0, 3}, 1, 0));
  model.links[1].inertia_kg_m2 = {0.0025, 0.00125, 0.00125};
  model.links[1].collisions.clear();
  model.joints = {Hinge("ball", 0, 1, {0, 0, 3})};
  model.joints[0].kind = JointModel::Kind::kBall;
  Add(model);
  constexpr double kSpin_rad_s = 100, kPrecession_rad_s = kG * 0.1 / (0.0025 * kSpin_rad_s);
  auto frame = scene_.Capture();
  BodyState& disc = frame->bodies[1];
  disc.w_WB = Vector3(kSpin_rad_s, 0, kPrecession_rad_s);
  disc.v_WB = disc.w_WB.cross(Vector3(0.1, 0, 0));
  scene_.Restore(*frame);
  double angle_rad = 0, last_rad = 0;
  for (int i = 0; i < 10'000 / GetParam(); ++i) {
    scene_.Run(1);
    const Vector3 p_W = LinkPose(*scene_.Capture(), 0, 1).p;
    const double now_rad = std::atan2(p_W.y(), p_W.x());
    angle_rad += std::remainder(now_rad - std::exchange(last_rad, now_rad), 2 * std::numbers::pi);
    EXPECT_NEAR(p_W.z(), 3, 1e-3);
  }
  EXPECT_NEAR(angle_rad / 10, kPrecession_rad_s, 0.005 * kPrecession_rad_s);
}

// A disc that turns freely on an axle, which a ball joint holds at its end.
TEST_P(FreeMotionTest, ARotorOnAnAxlePrecessesAtItsRate) {
  RobotModel model = OnAPost();
  model.links.push_back(Link("axle", {0.05, 0, 3}, 0.1, 1e-4));
  model.links.push_back(Link("disc", {0.1, 0, 3}, 1, 0));
  model.links[2].inertia_kg_m2 = {0.0025, 0.00125, 0.00125};
  for (const std::size_t link : {1, 2}) model.links[link].collisions.clear();
  model.joints = {Hinge("ball", 0, 1, {0, 0, 3}), Hinge("bearing", 1, 2, {0.1, 0, 3})};
  model.joints[0].kind = JointModel::Kind::kBall;
  model.joints[1].axis_R = Vector3::UnitX();
  Add(model);
  constexpr double kSpin_rad_s = 100, kPrecession_rad_s = kG * (0.1 + 0.1 * 0.05) / (0.0025 * kSpin_rad_s);
  auto frame = scene_.Capture();
  for (const std::size_t body : {1, 2}) {
    BodyState& state = frame->bodies[body];
    state.w_WB = {0, 0, kPrecession_rad_s};
    state.v_WB = state.w_WB.cross(state.p_WB - Vector3(0, 0, 3));
  }
  frame->bodies[2].w_WB.x() = kSpin_rad_s;
  scene_.Restore(*frame);
  double angle_rad = 0, last_rad = 0;
  for (int i = 0; i < 5000 / GetParam(); ++i) {
    scene_.Run(1);
    const Vector3 p_W = LinkPose(*scene_.Capture(), 0, 2).p;
    const double now_rad = std::atan2(p_W.y(), p_W.x());
    angle_rad += std::remainder(now_rad - std::exchange(last_rad, now_rad), 2 * std::numbers::pi);
    EXPECT_NEAR(p_W.z(), 3, 1e-3);
  }
  EXPECT_NEAR(angle_rad / 5, kPrecession_rad_s, 0.005 * kPrecession_rad_s);
}

// The axis of a free top turns about its angular momentum L at L / I, with I across the axis.
TEST_P(FreeMotionTest, AFreeTopPrecessesAtItsRate) {
  scene_.step_length = GetParam() * 1'000'000;
  constexpr double kMass_kg = 1, kRadius_m = 0.1, kLength_m = 0.05;
  constexpr double kAlong = kMass_kg * kRadius_m * kRadius_m / 2,
                   kAcross = kMass_kg * (3 * kRadius_m * kRadius_m + kLength_m * kLength_m) / 12;
  WorldObject top;
  top.shape = Cylinder{kRadius_m, kLength_m};
  top.X_WO = At(0, 0, 3);
  top.mass_kg = kMass_kg;
  const Vector3 w_W(20, 0, 100), L_W(kAcross * w_W.x(), 0, kAlong * w_W.z());
  top.w_WO = w_W;
  scene_.SetGravity(0).Add(top);
  constexpr double kDuration_s = 2;
  scene_.RunFor(kDuration_s);
  const Quaternion turned(Eigen::AngleAxisd(L_W.norm() / kAcross * kDuration_s, L_W.normalized()));
  const Vector3 axis_W = scene_.object(0).q * Vector3::UnitZ();
  EXPECT_LT((axis_W - turned * Vector3::UnitZ()).norm(), 0.02);
}

TEST_P(FreeMotionTest, AThrownBoxKeepsEnergyMomentumAndItsParabola) {
  scene_.step_length = GetParam() * 1'000'000;
  const Vector3 size_m(0.1, 0.2, 0.4);
  constexpr double kMass_kg = 2;
  const Vector3 inertia_kg_m2 =
      kMass_kg / 12 * (Vector3::Constant(size_m.squaredNorm()) - size_m.cwiseAbs2());
  scene_.Add(Box{size_m}, {{0, 0, 3}, Quaternion::Identity()}, kMass_kg);
  scene_.Build();
  auto frame = scene_.Capture();
  frame->bodies[0].v_WB = {1, 2, 60};
  frame->bodies[0].w_WB = 20 * Vector3(0.1, 0.9, 0.3).normalized();
  scene_.Restore(*frame);
  const auto turning = [&](const BodyState& body) {
    const Vector3 w_B = body.orientation().conjugate() * body.w_WB, L_B = inertia_kg_m2.cwiseProduct(w_B);
    return std::pair<double, Vector3>(w_B.dot(L_B) / 2, body.orientation() * L_B);
  };
  const auto [energy_j, L_W] = turning(frame->bodies[0]);
  scene_.RunFor(12);
  const BodyState body = scene_.Capture()->bodies[0];
  const auto [energy_after_j, L_after_W] = turning(body);
  EXPECT_NEAR(energy_after_j, energy_j, 2e-3 * energy_j);
  EXPECT_LT((L_after_W - L_W).norm(), 2e-3 * L_W.norm());
  EXPECT_LT((body.p_WB - Vector3(12, 24, 3 + 60 * 12 - kG * 72)).norm(), 1e-6);
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
  EXPECT_LT(Drift_j(30, 0) / energy_j, 1e-3);
}

/// A carriage of 2 kg on a spring of 1 Hz that rests at 0.1 m.
RobotModel CarriageOnASpring() {
  RobotModel model = OnAPost();
  model.links.push_back(Link("carriage", {0, 0, 3}, 2, 0.01));
  JointModel rail = Hinge("rail", 0, 1, {0, 0, 3});
  rail.kind = JointModel::Kind::kSlider;
  rail.axis_R = Vector3::UnitX();
  rail.stiffness = 2 * kOneHertz_rad_s * kOneHertz_rad_s;
  rail.rest = 0.1;
  model.joints = {rail};
  return model;
}

TEST_P(FreeMotionTest, ASpringKeepsItsAmplitude) {
  Add(CarriageOnASpring());
  scene_.RunFor(19.5);
  const auto [least_m, most_m] = Range([&] { return LinkPose(*scene_.Capture(), 0, 1).p.x(); });
  EXPECT_NEAR(least_m, 0, 1e-3);
  EXPECT_NEAR(most_m, 0.2, 1e-3);
}

TEST_P(FreeMotionTest, ADampedSpringFollowsItsFormula) {
  constexpr double kZeta = 0.1, kDecay = kZeta * kOneHertz_rad_s;
  RobotModel model = CarriageOnASpring();
  model.joints[0].damping = 2 * 2 * kDecay;
  Add(model);
  const double damped_rad_s = kOneHertz_rad_s * std::sqrt(1 - kZeta * kZeta);
  double worst_m = 0;
  for (int i = 1; i <= 3000 / GetParam(); ++i) {
    scene_.Run(1);
    const double t = i * GetParam() * 1e-3, angle = damped_rad_s * t;
    const double wanted_m =
        0.1 - 0.1 * std::exp(-kDecay * t) * (std::cos(angle) + kDecay / damped_rad_s * std::sin(angle));
    worst_m = std::max(worst_m, std::abs(LinkPose(*scene_.Capture(), 0, 1).p.x() - wanted_m));
  }
  EXPECT_LT(worst_m, 0.1 * 3e-5 * GetParam() * GetParam());  // 0.3 % at 10 ms: of second order
}

TEST_P(FreeMotionTest, SpringsInALoopKeepTheirAmplitude) {
  // Two cranks of 0.2 m and a rod between them, whose joint with the second crank closes the loop.
  RobotModel model = OnAPost();
  model.links.push_back(Link("crank1", {0, 0, 3.1}, 0.1, 0.001));
  model.links.push_back(Link("crank2", {0.4, 0, 3.1}, 0.1, 0.001));
  model.links.push_back(Link("rod", {0.2, 0, 3.2}, 1, 0.01));
  model.joints = {Hinge("a", 0, 1, {0, 0, 3}), Hinge("b", 0, 2, {0.4, 0, 3}), Hinge("c", 1, 3, {0, 0, 3.2}),
                  Hinge("d", 2, 3, {0.4, 0, 3.2})};
  constexpr double kInertia_kg_m2 = 2 * (0.001 + 0.1 * 0.1 * 0.1) + 0.2 * 0.2;
  for (std::size_t i = 0; i < 4; ++i) {
    model.links[i].collisions.clear();
    // The loop's joint has most of the spring.
    model.joints[i].stiffness = (i == 3 ? 0.97 : 0.01) * kInertia_kg_m2 * kOneHertz_rad_s * kOneHertz_rad_s;
    model.joints[i].rest = i < 2 ? 0.2 : -0.2;
  }
  scene_.SetGravity(0);
  Add(model);
  scene_.RunFor(19.5);
  const auto [least_rad, most_rad] = Range([&] {
    const Quaternion q = LinkPose(*scene_.Capture(), 0, 1).q;
    return 2 * std::atan2(q.y(), q.w());
  });
  EXPECT_NEAR(most_rad - least_rad, 0.4, 4e-3);
}

INSTANTIATE_TEST_SUITE_P(Steps, FreeMotionTest, ::testing::Values(1, 5, 10),
                         [](const auto& step) { return std::to_string(step.param) + "ms"; });

}  // namespace
}  // namespace coopdyn
