// SPDX-License-Identifier: MIT
// The description of a case to an engine, and the engine's interface.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/geometry/shape.h"

namespace coopdyn::frontier {

/// A box or a sphere, of uniform density unless `inertia_kg_m2` is given.
struct Body {
  Shape shape = Sphere{0.05};
  Pose X_W = {};        // of its centre, which is its centre of mass
  double mass_kg = 0;   // 0: static
  double friction = 1;  // against any other body
  Vector3 v_W = Vector3::Zero(), w_W = Vector3::Zero();
  Vector3 inertia_kg_m2 = Vector3::Zero();
};

/// The joint of body i of a tree with its parent. At the start, all bodies' axes are parallel to the world's.
struct Joint {
  enum class Kind { kFree, kBall, kHinge, kSlider };
  Kind kind = Kind::kHinge;
  int parent = -1;  // -1: the world
  Vector3 p_W = Vector3::Zero();
  Vector3 axis_W = Vector3::UnitY();
  double stiffness = 0, damping = 0, rest = 0;
};

/// Things on a floor, or one tree without contacts.
struct Setup {
  std::vector<Body> bodies = {};
  std::vector<Joint> joints = {};  // empty: things; else one per body, parents first
  double gravity_m_s2 = 9.81;
  bool fast = false;  // turns on an engine's protection against tunnelling, if it is not always on
};

struct Motion {
  Vector3 p_W;  // of the centre of mass
  Quaternion q_W;
  Vector3 v_W, w_W;
};

class Engine {
 public:
  virtual ~Engine() = default;
  virtual void Run(int steps) = 0;
  virtual std::vector<Motion> Motions() = 0;
};

std::unique_ptr<Engine> MakeCoopdyn(const Setup& setup, double step_s);
std::unique_ptr<Engine> MakeMujoco(const Setup& setup, double step_s, const std::string& integrator);
std::unique_ptr<Engine> MakeBullet(const Setup& setup, double step_s);
std::unique_ptr<Engine> MakeDart(const Setup& setup, double step_s);

std::string MujocoVersion();
std::vector<std::string> MujocoIntegrators();

Vector3 InertiaOf(const Body& body);
inline Vector3 SizeOf(const Body& body) {
  return std::holds_alternative<Box>(body.shape)
             ? std::get<Box>(body.shape).size_m
             : Vector3::Constant(2 * std::get<Sphere>(body.shape).radius_m);
}

}  // namespace coopdyn::frontier
