// SPDX-License-Identifier: MIT
// Joints of several axes with springs, stops and motors against closed forms, at 1, 5 and 10 ms.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "server/model/readers.h"
#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

std::string BoxLink(const std::string& name, const std::string& pose, double mass_kg,
                    const std::string& moments, const std::string& shape) {
  return "<link name=\"" + name + "\"><pose>" + pose + "</pose><inertial><mass>" + std::to_string(mass_kg) +
         "</mass><inertia>" + moments + "</inertia></inertial><collision name=\"c\"><geometry>" + shape +
         "</geometry></collision></link>\n";
}

const std::string kMoments = "<ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz>";
const std::string kSmall = "<sphere><radius>0.02</radius></sphere>";

std::shared_ptr<const RobotModel> Parse(const std::string& parts) {
  Diagnostics diagnostics;
  auto robot = ReadRobotModelText(
      "<sdf version=\"1.9\" xmlns:coopdyn=\"https://coopdyn.dev/sdf\"><model name=\"rig\">" + parts +
          "<coopdyn:module type=\"pose\"/></model></sdf>",
      "rig/model.sdf", "rig", diagnostics);
  EXPECT_EQ(diagnostics.ToString(), "");
  return robot;
}

/// A body of 2 kg joined to a post by `axes` at its centre of mass.
std::string OnPost(const std::string& axes) {
  return "<joint name=\"held\" type=\"fixed\"><parent>world</parent><child>post</child></joint>" +
         BoxLink("post", "0 0 3 0 0 0", 1, kMoments, kSmall) +
         BoxLink("body", "0 0 3 0 0 0", 2, kMoments, kSmall) +
         "<coopdyn:six_axis name=\"six\" parent=\"post\" child=\"body\">" + axes + "</coopdyn:six_axis>";
}

std::string Axis(const std::string& name, const std::string& words = "") {
  return "<coopdyn:axis name=\"" + name + "\" " + words + "/>";
}

class SixAxisTest : public ::testing::TestWithParam<int> {
 protected:
  void Add(const std::string& parts) {
    scene_.step_length = GetParam() * 1'000'000;
    scene_.robot_model = Parse(parts);
    ASSERT_NE(scene_.robot_model, nullptr);
    scene_.AddRobot(0, 0);
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
    const std::vector<LinkModel>& links = scene_.robot_model->links;
    body_ = static_cast<int>(std::ranges::find(links, "body", &LinkModel::name) - links.begin());
  }
  double step_s() const { return GetParam() * 1e-3; }
  Pose Where() { return LinkPose(*scene_.Capture(), 0, body_); }
  /// x, y, z, and the three turns of the chain rx, ry, rz.
  std::array<double, 6> Axes() {
    const Pose X = Where();
    const Matrix3 R = X.q.toRotationMatrix();
    return {X.p.x(),
            X.p.y(),
            X.p.z() - 3,
            std::atan2(-R(1, 2), R(2, 2)),
            std::asin(std::clamp(R(0, 2), -1.0, 1.0)),
            std::atan2(-R(0, 1), R(0, 0))};
  }

  PhysicsScene scene_;
  int body_ = 0;
};

TEST_P(SixAxisTest, EachAxisSwingsOnItsSpringWithItsPeriod) {
  // From 0 about its rest position; z also carries the weight. All at once: the springs act at the centre of
  // mass.
  std::string axes;
  const char* const names[] = {"x", "y", "z", "rx", "ry", "rz"};
  const double stiffness[] = {80, 120, 200, 0.9, 1.1, 1.3}, inertia[] = {2, 2, 2, 0.02, 0.03, 0.04};
  for (int i = 0; i < 6; ++i)
    axes += Axis(names[i], "stiffness=\"" + std::to_string(stiffness[i]) + "\" rest=\"0.01\"");
  Add(OnPost(axes));
  std::array<double, 6> rest{}, before{}, first_s{}, last_s{};
  for (std::size_t i = 0; i < 6; ++i) rest[i] = 0.01;
  rest[2] -= 2 * kG / stiffness[2];
  std::array<int, 6> crossings{};
  before = Axes();
  for (int step = 1; step <= static_cast<int>(8 / step_s()); ++step) {
    scene_.Run(1);
    const std::array<double, 6> now = Axes();
    for (std::size_t i = 0; i < 6; ++i) {
      const double a = before[i] - rest[i], b = now[i] - rest[i];
      if (a >= 0 || b < 0) continue;
      last_s[i] = (step - b / (b - a)) * step_s();
      if (crossings[i]++ == 0) first_s[i] = last_s[i];
    }
    before = now;
  }
  for (std::size_t i = 0; i < 6; ++i) {
    ASSERT_GT(crossings[i], 3) << names[i];
    const double period_s = (last_s[i] - first_s[i]) / (crossings[i] - 1);
    EXPECT_NEAR(period_s / (kTurn * std::sqrt(inertia[i] / stiffness[i])), 1, 0.01) << names[i];
  }
}

TEST_P(SixAxisTest, ADampedSpringFollowsTheFormula) {
  Add(OnPost(Axis("x", "stiffness=\"50\" damping=\"4\" rest=\"0.2\"") + Axis("rz")));
  const double decay = 4 / (2 * 2.0), omega = std::sqrt(50 / 2.0 - decay * decay);
  for (int i = 1; i <= static_cast<int>(2 / step_s()); ++i) {
    scene_.Run(1);
    const double t_s = i * step_s();
    const double way_m =
        std::exp(-decay * t_s) * (std::cos(omega * t_s) + decay / omega * std::sin(omega * t_s));
    // An implicit step adds damping of ω² h / 2.
    const double more = 25 * step_s() / 2 * t_s * std::exp(-decay * t_s);
    ASSERT_NEAR(Axes()[0], 0.2 * (1 - way_m), 0.2 * more + 1e-4 * GetParam()) << t_s;
  }
}

TEST_P(SixAxisTest, StopsHoldAndLockedAxesDoNotMove) {
  // The body falls onto the stop of z; springs with rest positions far beyond the stops pull the others onto
  // theirs.
  Add(OnPost(Axis("x", "lower=\"-0.1\" upper=\"0.05\" stiffness=\"40\" rest=\"1\"") +
             Axis("z", "lower=\"-0.1\" upper=\"0\"") +
             Axis("rx", "lower=\"-0.3\" upper=\"0.2\" stiffness=\"1\" rest=\"-2\"") +
             Axis("rz", "lower=\"-0.3\" upper=\"0.4\" stiffness=\"1\" rest=\"2\"")));
  scene_.RunFor(3);
  const std::array<double, 6> now = Axes(), wanted = {0.05, 0, -0.1, -0.3, 0, 0.4};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(now[i], wanted[i], 2e-3) << i;
}

TEST_P(SixAxisTest, WithAllAxesFreeItFallsAsByItself) {
  Add(OnPost(Axis("x") + Axis("y") + Axis("z") + Axis("rx") + Axis("ry") + Axis("rz")));
  scene_.RunFor(0.5);
  const double t_s = 0.5;
  EXPECT_NEAR(Axes()[2], -kG / 2 * t_s * t_s, 1e-6);
}

TEST_P(SixAxisTest, TheLinksBetweenTheAxesWeighNothing) {
  Add(OnPost(Axis("x") + Axis("z", "stiffness=\"10\"") + Axis("ry")));
  double carriers_kg = 0, least = 1;
  for (const LinkModel& link : scene_.robot_model->links) {
    if (!link.is_carrier) continue;
    carriers_kg += link.mass_kg;
    least = std::min(least, link.inertia_kg_m2.minCoeff());
    EXPECT_TRUE(link.collisions.empty() && link.visuals.empty());
  }
  EXPECT_GT(carriers_kg, 0);
  EXPECT_LT(carriers_kg, 2 * 1e-5);
  EXPECT_GT(least, 0);
}

/// A chassis on four wheels with suspension, steering in front.
std::string Car() {
  const std::string wheel = "<cylinder><radius>0.1</radius><length>0.05</length></cylinder>";
  const std::string moments = "<ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz>";
  std::string text = BoxLink("body", "0 0 0.3 0 0 0", 20, "<ixx>0.5</ixx><iyy>1</iyy><izz>1.2</izz>",
                             "<box><size>0.8 0.4 0.1</size></box>");
  for (const char* x : {"0.3", "-0.3"}) {
    for (const char* y : {"0.3", "-0.3"}) {
      const std::string name = std::string("w") + x + y;
      text += BoxLink(name, std::string(x) + " " + y + " 0.1 1.5707963267949 0 0", 1, moments, wheel);
      text +=
          "<coopdyn:six_axis name=\"j" + name + "\" parent=\"body\" child=\"" + name +
          "\" relative_to=\"__model__\" pose=\"" + x + " " + y + " 0.1 0 0 0\">" +
          Axis("z", "stiffness=\"2000\" damping=\"150\" lower=\"-0.1\" upper=\"0.1\"") +
          (*x == '0' ? Axis("rz", "max_effort=\"20\" max_velocity=\"2\" lower=\"-0.6\" upper=\"0.6\"") : "") +
          Axis("ry") + "</coopdyn:six_axis>";
    }
  }
  return text;
}

TEST_P(SixAxisTest, ACarSinksIntoItsSuspensionAndStands) {
  Add(Car());
  scene_.RunFor(4);
  const Pose X = Where();
  EXPECT_NEAR(X.p.z(), 0.3 - 20 * kG / (4 * 2000), 1e-3);
  EXPECT_LT(std::abs(X.p.x()) + std::abs(X.p.y()), 2e-3);
  EXPECT_LT(TiltOf(X), 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Steps, SixAxisTest, ::testing::Values(1, 5, 10));

}  // namespace
}  // namespace coopdyn
