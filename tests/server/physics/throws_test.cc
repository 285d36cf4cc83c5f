// SPDX-License-Identifier: MIT
// Shipped robots, limp, thrown and spun at random: none explodes, and none gains energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server/base/random.h"
#include "server/model/readers.h"
#include "tests/server/physics/physics_scene.h"
#include "tests/source_dir.h"

namespace coopdyn {
namespace {

double Energy_j(PhysicsScene& scene) {
  const Mechanism& mechanism = *scene.world().things().all[0].mechanism;
  const auto frame = scene.Capture();
  double sum_j = 0;
  for (std::size_t i = mechanism.fixed_base ? 1 : 0; i < mechanism.bodies.size(); ++i) {
    const RigidBody& of = mechanism.bodies[i];
    const BodyState& body = frame->bodies[i];
    const Vector3 w_B = body.orientation().conjugate() * body.w_WB;
    sum_j +=
        of.mass_kg * (kG * body.p_WB.z() + body.v_WB.squaredNorm() / 2) + w_B.dot(of.inertia_kg_m2 * w_B) / 2;
  }
  return sum_j;
}

std::vector<std::string> ShippedRobots() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(SourceDir() + "/robots")) {
    if (entry.is_directory()) names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

class ThrowsTest : public ::testing::TestWithParam<std::string> {};

TEST_P(ThrowsTest, ALimpRobotGainsNoEnergy) {
  constexpr int kThrows = 65;  // 1,000 in all
  constexpr double kMostGain = 0.04;
  const SearchPath path{{SourceDir()}};
  Diagnostics diagnostics;
  const auto file = path.FindRobot(GetParam());
  ASSERT_TRUE(file);
  const auto model = ReadRobotModel(file->string(), path, diagnostics);
  ASSERT_TRUE(model) << diagnostics.ToString();
  RandomNumbers random(7);
  const auto draw = [&random] { return 2 * random.Next() - 1; };
  const auto draw3 = [&draw] {
    const double x = draw(), y = draw();
    return Vector3(x, y, draw());
  };
  for (int i = 0; i < kThrows; ++i) {
    PhysicsScene scene;
    scene.robot_model = model;
    const Vector3 turn = draw3();
    const Quaternion q(Eigen::AngleAxisd(3 * draw(), turn.normalized()));
    scene.AddRobot(model->fixed_base ? Pose() : Pose{{0, 0, 3}, q});
    scene.Build();
    ASSERT_EQ(scene.diagnostics().ToString(), "");
    auto frame = scene.Capture();
    scene.setpoints.assign(frame->channels.size(), {0, ControlMode::kIdle});
    const Vector3 v_W = 5 * draw3(), w_W = 20 * draw3(), p_W = frame->bodies[0].p_WB;
    for (BodyState& body : frame->bodies) {
      if (model->fixed_base) break;
      body.w_WB = w_W;
      body.v_WB = v_W + w_W.cross(body.p_WB - p_W);
    }
    scene.Restore(*frame);
    const double start_j = Energy_j(scene);
    double least_j = start_j, gain_j = 0;
    for (int step = 0; step < 300; ++step) {
      scene.Run(1);
      const double energy_j = Energy_j(scene);
      least_j = std::min(least_j, energy_j);
      gain_j = std::max(gain_j, energy_j - least_j);
    }
    EXPECT_LT(gain_j, kMostGain * std::max(1.0, start_j)) << "throw " << i;
    EXPECT_TRUE(scene.world().TakeFrozen().empty()) << "throw " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, ThrowsTest, ::testing::ValuesIn(ShippedRobots()),
                         [](const auto& robot) { return robot.param; });

}  // namespace
}  // namespace coopdyn
