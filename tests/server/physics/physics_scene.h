// SPDX-License-Identifier: MIT
// Scenes of three lines for physics tests: a robot like coopbot built by hand, objects, and a world that
// steps. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/physics/world.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {

/// A two-wheeled robot with the dimensions of coopbot: wheels of 7.5 cm, track 28 cm, 10 kg.
std::shared_ptr<const RobotModel> TestRobot();
/// One with the dimensions of minibot: wheels of 3 cm, track 14 cm, 1.6 kg.
std::shared_ptr<const RobotModel> SmallRobot();
/// A solid box as a link.
LinkModel Block(const char* name, const Vector3& p_RL, const Vector3& size_m, double mass_kg);

inline constexpr double kG = 9.81;  // of gravity, m/s²

/// Upright at a point, m.
inline Pose At(double x, double y, double z) {
  return {{x, y, z}, Quaternion::Identity()};
}

/// Angle between a robot's z axis and the vertical, rad.
double TiltOf(const Pose& pose);

/// A scene, its physics and its newest frame.
class PhysicsScene {
 public:
  PhysicsScene& AddRobot(double x_m, double y_m, double heading_rad = 0);
  PhysicsScene& AddRobot(const Pose& X_WR);
  /// A box, cylinder or sphere; mass 0: static. Named like THING_1.
  PhysicsScene& Add(const Shape& shape, const Pose& X_WO, double mass_kg = 0, double friction = 1);
  PhysicsScene& Add(WorldObject object);
  PhysicsScene& SetFloorFriction(double friction);
  PhysicsScene& SetGravity(double down_m_s2) { return SetGravity(Vector3(0, 0, -down_m_s2)); }
  PhysicsScene& SetGravity(const Vector3& g_W);
  /// As `overlaps yes` of a scenario.
  PhysicsScene& AllowOverlaps();

  /// Builds physics. Called by the first use; a test calls it to see the diagnostics.
  void Build();
  const Diagnostics& diagnostics() const { return diagnostics_; }
  bool built() const { return world_ != nullptr; }

  /// Wheel speeds (left, right, rad/s) of a robot until the next call.
  void SetWheels(int robot, double left_rad_s, double right_rad_s);
  /// Wheel speeds of an ideal differential drive, of the robot's own dimensions.
  void SetVelocity(int robot, double linear_m_s, double angular_rad_s);
  /// Makes `steps` steps of `step_length`, with `substeps` (0: the default).
  void Run(int steps);
  void RunFor(double duration_s);

  /// The state now; hash and time included.
  std::shared_ptr<Frame> Capture();
  void Restore(const Frame& frame);

  Pose robot(int index);
  int robot_count() const { return static_cast<int>(scenario_.robots.size()); }
  Pose object(int index);
  const BodyState& object_body(int index);

  /// Throws if the scene could not be built.
  PhysicsWorld& world();
  Nanoseconds step_length = kDefaultStep;
  int substeps = 0;
  std::vector<Setpoint> setpoints;  // of all channels; empty: as SetWheels() says
  // Of robots added from now on.
  std::shared_ptr<const RobotModel> robot_model;  // null: TestRobot()
  Fidelity fidelity = Fidelity::kFull;
  WorkerPool* pool = nullptr;  // of the world to be built

 private:
  Scenario scenario_;
  std::shared_ptr<const Scene> scene_;
  std::unique_ptr<PhysicsWorld> world_;
  Diagnostics diagnostics_;
  std::vector<WheelSpeeds> setpoints_;
  std::uint64_t step_ = 0;
  Nanoseconds time_ = 0;
  std::shared_ptr<Frame> frame_;
};

/// What physics measures for a robot's sensor now.
inline std::vector<double> MeasuredBy(PhysicsScene& scene, int robot = 0, std::size_t sensor = 0) {
  const std::span<const double> values = MeasuredOf(*scene.Capture(), robot, sensor);
  return {values.begin(), values.end()};
}

}  // namespace coopdyn
