// SPDX-License-Identifier: MIT
// Light sensors against the formula of docs/physics.md.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "server/sensing/readings.h"
#include "tests/server/sensing/mounted.h"

namespace coopdyn::range_sensors {
namespace {

using testing::ElementsAre;

LightModel Eyes(std::initializer_list<double> openings_rad) {
  LightModel light;
  for (const double opening_rad : openings_rad) light.eyes.push_back({OnTop(), opening_rad});
  return light;
}

PointLight Lamp(const Vector3& p_WP, double power) {
  PointLight lamp;
  lamp.p_WP = p_WP;
  lamp.power = power;
  return lamp;
}

std::vector<double> LightOf(SampleWorld world, const std::vector<PointLight>& lamps, double ambient = 0) {
  const auto frame = world.MakeFrame();
  auto scenario = std::make_shared<Scenario>(*frame->scene->scenario);
  scenario->lights = lamps;
  scenario->ambient_light = ambient;
  frame->scene = MakeScene(scenario);
  return LightValues(*frame, 0);
}

TEST(LightTest, ALampGivesItsPowerByTheSquareOfTheDistanceAndTheAngle) {
  const auto robot = SampleWorld().Robot(At(0, 0), With(Eyes({0, 1.0})));
  const Vector3 ahead(2, 0, kEye_m), beside(2 * std::cos(0.2), 2 * std::sin(0.2), kEye_m);
  EXPECT_THAT(LightOf(robot, {Lamp(ahead, 8)}),
              ElementsAre(testing::DoubleNear(2, 1e-9), testing::DoubleNear(2, 1e-9)));
  // 0.2 of the half opening of 0.5.
  EXPECT_THAT(LightOf(robot, {Lamp(beside, 8)}),
              ElementsAre(testing::DoubleNear(2, 1e-9), testing::DoubleNear(2 * 0.6, 1e-9)));
  const Vector3 behind(-2, 0, kEye_m);
  EXPECT_THAT(LightOf(robot, {Lamp(behind, 8)}), ElementsAre(testing::DoubleNear(2, 1e-9), 0));
}

TEST(LightTest, LampsAddUpWithTheAmbientLightAndCountByTheirBrightness) {
  const auto robot = SampleWorld().Robot(At(0, 0), With(Eyes({0})));
  PointLight red = Lamp({0, 2, kEye_m}, 12);
  red.color = {1, 0, 0};  // a third of white
  EXPECT_THAT(LightOf(robot, {Lamp({2, 0, kEye_m}, 8), red}, 0.5),
              ElementsAre(testing::DoubleNear(2 + 1 + 0.5, 1e-9)));
}

TEST(LightTest, WhatStandsBetweenHidesALampUnlessItCastsNoShadows) {
  const auto world =
      SampleWorld().Robot(At(0, 0), With(Eyes({0}))).Object(Box{{0.1, 1, 1}}, Stands(1, 0, kEye_m));
  PointLight lamp = Lamp({2, 0, kEye_m}, 8);
  EXPECT_THAT(LightOf(world, {lamp}, 0.1), ElementsAre(testing::DoubleNear(0.1, 1e-9)));
  lamp.casts_shadows = false;
  EXPECT_THAT(LightOf(world, {lamp}, 0.1), ElementsAre(testing::DoubleNear(2.1, 1e-9)));
  // Behind the lamp it hides nothing.
  const auto behind =
      SampleWorld().Robot(At(0, 0), With(Eyes({0}))).Object(Box{{0.1, 1, 1}}, Stands(3, 0, kEye_m));
  EXPECT_THAT(LightOf(behind, {Lamp({2, 0, kEye_m}, 8)}), ElementsAre(testing::DoubleNear(2, 1e-9)));
}

}  // namespace
}  // namespace coopdyn::range_sensors
