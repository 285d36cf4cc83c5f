// SPDX-License-Identifier: MIT
// Things that overlap at the start are errors that state the depth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;

const Box kBlock{Vector3(0.4, 0.4, 0.4)};

TEST(StartCheck, DynamicBoxInsideAWallIsAnErrorAtItsLine) {
  PhysicsScene scene;
  scene.Add(Box{Vector3(0.2, 4, 0.5)}, At(1, 0, 0.25)).Add(kBlock, At(0.82, 0, 0.2), 1).Build();
  EXPECT_FALSE(scene.built());
  EXPECT_EQ(scene.diagnostics().ToString(),
            "test.world:2: error: box THING_2 starts 0.12 m inside THING_1: move it\n");
}

TEST(StartCheck, RobotInsideAWallIsAnErrorAtItsLine) {
  PhysicsScene scene;
  scene.Add(Box{Vector3(0.2, 4, 0.5)}, At(1, 0, 0.25)).AddRobot(0.75, 0).Build();
  EXPECT_FALSE(scene.built());
  EXPECT_EQ(scene.diagnostics().ToString(),
            "test.scenario:100: error: robot robot1 starts 0.03 m inside THING_1: move it\n");
}

TEST(StartCheck, AllMistakesComeAtOnce) {
  PhysicsScene scene;
  scene.AddRobot(0, 0).AddRobot(0.3, 0);
  scene.Add(kBlock, At(3, 0, 0.15), 1).Add(Sphere{0.2}, At(3.1, 0, 0.5), 1).Build();
  EXPECT_FALSE(scene.built());
  const std::string text = scene.diagnostics().ToString();
  EXPECT_EQ(scene.diagnostics().errors(), 3) << text;
  EXPECT_THAT(text, HasSubstr("box THING_1 starts 0.05 m below the floor (z = 0): move it up"));
  EXPECT_THAT(text, HasSubstr("sphere THING_2 starts 0.05 m inside THING_1: move it"));
  EXPECT_THAT(text, HasSubstr("robot robot2 starts 0.06 m inside robot1: move it"));
}

TEST(StartCheck, AThingWhollyWithinAnotherIsFound) {
  for (const Shape& inner :
       {Shape(Box{Vector3(0.1, 0.1, 0.1)}), Shape(Sphere{0.05}), Shape(Cylinder{0.05, 0.1})}) {
    for (const Shape& outer : {Shape(Box{Vector3(2, 2, 2)}), Shape(Sphere{1}), Shape(Cylinder{1, 2})}) {
      PhysicsScene scene;
      scene.Add(outer, At(0, 0, 1)).Add(inner, {{0.1, 0.05, 1.02}, FromRollPitchYaw(0.3, 0.2, 0)}, 1).Build();
      EXPECT_FALSE(scene.built()) << inner.index() << " in " << outer.index();
    }
  }
}

TEST(StartCheck, TouchingIsAllowed) {
  PhysicsScene scene;
  scene.Add(kBlock, At(1, 0, 0.2), 1).Add(kBlock, At(1.4, 0, 0.2), 1).Add(kBlock, At(1, 0, 0.6), 1);
  scene.AddRobot(0.6205, 0).AddRobot(0.2605, 0).Build();
  EXPECT_TRUE(scene.built()) << scene.diagnostics().ToString();
}

TEST(StartCheck, StaticThingsMayOverlap) {
  PhysicsScene scene;
  scene.Add(kBlock, At(1, 0, 0.1)).Add(kBlock, At(1.1, 0, 0)).Build();
  EXPECT_TRUE(scene.built());
}

TEST(StartCheck, WhatMayNeverComeOutIsSaid) {
  const auto said = [](double x) {
    PhysicsScene scene;
    scene.Add(Box{Vector3(2, 2, 2)}, At(0, 0, 1)).Add(Sphere{0.1}, At(x, 0, 1), 1);
    scene.AllowOverlaps().Build();
    return scene.diagnostics().ToString();
  };
  EXPECT_EQ(said(0.6),
            "test.world:2: warning: sphere THING_2 starts 0.5 m inside THING_1, more than half of it: it may "
            "never come out, so move it\n");
  EXPECT_THAT(said(1.05), HasSubstr("it is pushed out slowly"));
}

TEST(StartCheck, WhatMayOverlapIsPushedOutSlowlyWithAWarning) {
  PhysicsScene scene;
  scene.Add(Box{Vector3(0.2, 4, 0.5)}, At(1, 0, 0.25)).Add(kBlock, At(0.82, 0, 0.2), 1);
  scene.Add(kBlock, At(-3, 0, 0.2), 1).Add(kBlock, At(-3, 0, 0.5), 1).Add(kBlock, At(3, 0, 0.1), 1);
  scene.AllowOverlaps().Build();
  ASSERT_TRUE(scene.built()) << scene.diagnostics().ToString();
  EXPECT_EQ(scene.diagnostics().errors(), 0);
  EXPECT_THAT(
      scene.diagnostics().ToString(),
      HasSubstr("test.world:2: warning: box THING_2 starts 0.12 m inside THING_1: it is pushed out slowly"));
  double fastest_m_s = 0;
  for (int i = 0; i < 400; ++i) {
    scene.Run(1);
    for (const int k : {1, 2, 3, 4}) fastest_m_s = std::max(fastest_m_s, scene.object_body(k).v_WB.norm());
  }
  EXPECT_LT(fastest_m_s, 0.5);
  EXPECT_NEAR(scene.object(1).p.x(), 0.7, 2e-3);
  EXPECT_NEAR(scene.object(2).p.z(), 0.2, 2e-3);
  EXPECT_NEAR(scene.object(3).p.z(), 0.6, 4e-3);
  EXPECT_NEAR(scene.object(4).p.z(), 0.2, 2e-3);
}

}  // namespace
}  // namespace coopdyn
