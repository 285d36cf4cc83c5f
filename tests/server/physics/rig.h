// SPDX-License-Identifier: MIT
// Robots of links and hinges that a test builds by hand.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "tests/server/physics/physics_scene.h"

namespace coopdyn {

inline LinkModel Link(const std::string& name, const Vector3& p_R, double mass_kg, double inertia_kg_m2) {
  LinkModel link;
  link.name = name;
  link.X_RL.p = p_R;
  link.mass_kg = mass_kg;
  link.inertia_kg_m2 = Vector3::Constant(inertia_kg_m2);
  link.collisions = {{Sphere{0.02}, {}, {}, 1, false}};
  return link;
}

inline JointModel Hinge(const std::string& name, int parent, int child, const Vector3& p_R) {
  JointModel joint;
  joint.name = name;
  joint.parent = parent;
  joint.child = child;
  joint.p_RJ = p_R;
  return joint;
}

/// A base in the world at a height of 3 m.
inline RobotModel OnAPost() {
  RobotModel model;
  model.type = "rig";
  model.fixed_base = true;
  model.links = {Link("base", {0, 0, 3}, 1, 0.01)};
  model.footprint_radius_m = 0.02;
  model.height_m = 3;
  return model;
}

/// A world with one of them, in steps of `step_ms`.
inline void BuildWith(RobotModel model, int step_ms, PhysicsScene& scene) {
  scene.step_length = step_ms * 1'000'000;
  scene.robot_model = std::make_shared<const RobotModel>(std::move(model));
  scene.AddRobot(0, 0);
  scene.Build();
  ASSERT_EQ(scene.diagnostics().ToString(), "");
}

}  // namespace coopdyn
