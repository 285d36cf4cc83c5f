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
  for (const double opening_rad : openings_rad) light.eyes.push_back({OnTop(), opening_rad, true, {}});
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

TEST(LightTest, AnEyeMaySeeTheAmbientLightAlone) {
  LightModel light = Eyes({0});
  light.eyes[0].sees_lamps = false;
  const auto robot = SampleWorld().Robot(At(0, 0), With(light));
  EXPECT_THAT(LightOf(robot, {Lamp({2, 0, kEye_m}, 8)}, 0.3), ElementsAre(0.3));
}

// sum over colours of min(sum over lamps of power · colour / d², the eye's) / the sum of the eye's colours
TEST(LightTest, AnEyeWithAColourSaturatesInEachColour) {
  LightModel eye = Eyes({1.0});
  eye.eyes[0].color = Vector3(1, 0.5, 0);
  const auto robot = SampleWorld().Robot(At(0, 0), With(eye));
  PointLight lamp = Lamp({2, 0, kEye_m}, 2);
  lamp.color = {0.8, 0.2, 1};
  const double red = 2 * 0.8 / 4, green = 2 * 0.2 / 4;
  const auto near = [](double value) { return ElementsAre(testing::DoubleNear(value, 1e-9)); };
  EXPECT_THAT(LightOf(robot, {lamp}, 0.3), near((red + green) / 1.5));  // no ambient light, no blue
  PointLight beside = lamp;
  beside.p_WP = Vector3(2 * std::cos(0.4), 2 * std::sin(0.4), kEye_m);
  EXPECT_THAT(LightOf(robot, {beside}), near((red + green) / 1.5));  // no loss off the axis
  EXPECT_THAT(LightOf(robot, {lamp, beside}), near((2 * red + 2 * green) / 1.5));
  EXPECT_THAT(LightOf(robot, {lamp, beside, lamp}), near((1 + 3 * green) / 1.5));  // red is full
  beside.p_WP = Vector3(2 * std::cos(0.6), 2 * std::sin(0.6), kEye_m);
  EXPECT_THAT(LightOf(robot, {beside}), ElementsAre(0));
  EXPECT_THAT(LightOf(robot, {Lamp({2, 0, kEye_m}, 100)}), ElementsAre(1));
}

}  // namespace
}  // namespace coopdyn::range_sensors
