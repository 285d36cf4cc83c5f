// SPDX-License-Identifier: MIT
// Ranges against a reference that intersects every ray with every shape.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "server/geometry/ray.h"
#include "server/sensing/readings.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/sensing/sample_frame.h"

namespace coopdyn {
namespace {

constexpr double kAgreed_m = 1e-9;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double Uniform(double min, double max) {
    return min + (max - min) * std::uniform_real_distribution<>()(engine_);
  }
  int Int(int count) { return static_cast<int>(engine_() % static_cast<unsigned>(count)); }
  bool OneIn(int count) { return Int(count) == 0; }

 private:
  std::mt19937 engine_;
};

double ToShape(const Ray& ray_W, const Shape& shape, const Pose& X_WG) {
  const Matrix3 R_GW = X_WG.q.toRotationMatrix().transpose();
  return RayToShape({R_GW * (ray_W.origin - X_WG.p), R_GW * ray_W.direction}, shape);
}

/// Distance to the nearest object or other robot on `ray_W`, without a limit.
double ReferenceAbove(const Frame& frame, int self, const Ray& ray_W) {
  double nearest_m = kNoHit;
  for (const SceneObject& object : frame.scene->objects) {
    nearest_m = std::min(nearest_m, ToShape(ray_W, object.object.shape, ObjectPose(frame, object)));
  }
  for (int robot = 0; robot < static_cast<int>(frame.scene->robots.size()); ++robot) {
    if (robot == self) continue;
    const auto& links = frame.scene->robots[static_cast<std::size_t>(robot)].entry.model->links;
    for (std::size_t link = 0; link < links.size(); ++link) {
      const Pose X_WL = LinkPose(frame, robot, static_cast<int>(link));
      for (const LinkShape& collision : links[link].collisions) {
        nearest_m = std::min(nearest_m, ToShape(ray_W, collision.shape, X_WL * collision.X_LG));
      }
    }
  }
  return nearest_m;
}

/// The same including the floor.
double Reference(const Frame& frame, int self, const Ray& ray_W) {
  return std::min(ReferenceAbove(frame, self, ray_W), RayToFloor(ray_W));
}

std::vector<double> ReferenceDistances(const Frame& frame, int robot) {
  std::vector<double> ranges_m;
  const RobotModel& model = *frame.scene->robots[static_cast<std::size_t>(robot)].entry.model;
  for (const SectorModel& sensor : model.sectors()) {
    const Pose X_WS = RobotPose(frame, robot) * sensor.X_RS;
    double nearest_m = kNoHit;
    for (int i = 0; i < sensor.rays; ++i) {
      const double angle_rad = sensor.rays > 1 ? sensor.opening_rad * (1.0 * i / (sensor.rays - 1) - 0.5) : 0;
      const Ray ray{X_WS.p, X_WS.q * Vector3(std::cos(angle_rad), std::sin(angle_rad), 0)};
      const double range_m = Reference(frame, robot, ray);
      if (range_m <= sensor.max_range_m) nearest_m = std::min(nearest_m, range_m);
    }
    ranges_m.push_back(nearest_m);
  }
  return ranges_m;
}

/// A robot with a body, casters and coaxial cylinder wheels, and typical sensors.
std::shared_ptr<RobotModel> RandomRobot(Random& random) {
  auto model = std::make_shared<RobotModel>();
  const double radius_m = random.Uniform(0.05, 0.25), wheel_m = radius_m * random.Uniform(0.3, 0.6);
  LinkModel chassis;
  chassis.X_RL.p = {0, 0, random.Uniform(0, 0.05)};
  chassis.X_LI = {{random.Uniform(-0.02, 0.02), 0, 0.03},
                  FromRollPitchYaw(0, 0, random.OneIn(2) ? 0 : random.Uniform(-1, 1))};
  chassis.mass_kg = 1;
  const Pose X_LG{{random.OneIn(2) ? 0 : random.Uniform(-0.02, 0.02), 0, wheel_m + 0.02},
                  random.OneIn(4) ? FromRollPitchYaw(0.3, -0.2, 1) : Quaternion::Identity()};
  const Shape body = random.OneIn(3)   ? Shape(Box{{radius_m, 1.5 * radius_m, wheel_m}})
                     : random.OneIn(4) ? Shape(Sphere{radius_m})
                                       : Shape(Cylinder{radius_m, random.Uniform(0.5, 2) * wheel_m});
  chassis.collisions = {
      {body, X_LG, {}, 1, true},
      {Sphere{0.2 * wheel_m}, {{0.7 * radius_m, 0, 0}, Quaternion::Identity()}, {}, 0, false}};
  model->links.push_back(chassis);
  for (const double side : {1.0, -1.0}) {
    LinkModel wheel;
    wheel.X_RL = {{0, side * random.Uniform(0.5, 1.1) * radius_m, wheel_m},
                  FromRollPitchYaw(-std::numbers::pi / 2, 0, 0)};
    wheel.mass_kg = 0.1;
    const Vector3 off(random.OneIn(3) ? 0.3 * wheel_m : 0, 0, 0);  // sometimes an eccentric wheel
    wheel.collisions = {{Cylinder{wheel_m, 0.2 * radius_m}, {off, Quaternion::Identity()}, {}, 1, false}};
    model->links.push_back(wheel);
    JointModel joint;
    joint.child = side > 0 ? 1 : 2;
    joint.p_RJ = wheel.X_RL.p;
    model->joints.push_back(joint);
  }
  const int sensors = 1 + random.Int(random.OneIn(5) ? 90 : 24);
  const bool is_short = random.OneIn(2), is_wild = random.OneIn(4);
  const double height_m = random.Uniform(0.5, 2.5) * wheel_m;
  for (int i = 0; i < sensors; ++i) {
    SectorModel sensor;
    const double bearing = 2 * std::numbers::pi * i / sensors - std::numbers::pi;
    sensor.X_RS.q =
        is_wild ? FromRollPitchYaw(random.Uniform(-3, 3), random.Uniform(-1.5, 1.5), random.Uniform(-3, 3))
                : FromRollPitchYaw(0, random.OneIn(9) ? 0.2 : 0, bearing);
    sensor.X_RS.p = FromRollPitchYaw(0, 0, bearing) * Vector3(radius_m, 0, height_m);
    sensor.max_range_m = is_short ? random.Uniform(0.05, 0.3) : random.Uniform(1, 6);
    sensor.rays = random.OneIn(2) ? 1 : 5;
    sensor.opening_rad = sensor.rays > 1 ? random.Uniform(0.05, 2) : 0;
    SensorOf<DistanceModel>(*model).sectors.push_back(sensor);
  }
  model->height_m = 2 * wheel_m;
  SensorOf<TargetModel>(*model).see_through = false;
  return model;
}

class RandomWorld {
 public:
  explicit RandomWorld(unsigned seed) : random_(seed) {
    std::vector<std::shared_ptr<RobotModel>> models;
    for (int i = 0; i < 1 + random_.Int(3); ++i) models.push_back(RandomRobot(random_));
    const double half_m = random_.Uniform(0.5, 6);
    const int robots = 2 + random_.Int(40), objects = random_.Int(random_.OneIn(3) ? 60 : 6);
    for (int i = 0; i < robots; ++i) {
      Pose X_WR = At(random_.Uniform(-half_m, half_m), random_.Uniform(-half_m, half_m),
                     random_.Uniform(-std::numbers::pi, std::numbers::pi));
      if (random_.OneIn(3)) X_WR.q = X_WR.q * Tilt(1e-3);
      if (random_.OneIn(8)) {
        X_WR.q = X_WR.q * Tilt(3);
        X_WR.p.z() = random_.Uniform(-0.05, 0.3);
      }
      world_.Robot(X_WR, models[static_cast<std::size_t>(random_.Int(static_cast<int>(models.size())))]);
    }
    for (int i = 0; i < objects; ++i) {
      const Pose X_WO{
          {random_.Uniform(-half_m, half_m), random_.Uniform(-half_m, half_m), random_.Uniform(0, 0.3)},
          random_.OneIn(2) ? Tilt(3) : Quaternion::Identity()};
      world_.Object(RandomShape(), X_WO, random_.OneIn(2) ? 1 : 0);
    }
    if (random_.OneIn(2)) world_.Object(Box{{90, 0.1, 1}}, {{0, half_m, 0.5}, Quaternion::Identity()});
  }

  /// Adds targets that may be hidden.
  void AddTargets() {
    for (int i = 0; i < 6; ++i) {
      world_.Mark(random_.Uniform(-6, 6), random_.Uniform(-6, 6), random_.Uniform(0, 0.5));
    }
  }

  /// Wheels turned, and slightly displaced if they are separate bodies.
  std::unique_ptr<Frame> MakeFrame(Fidelity fidelity) {
    auto frame = world_.MakeFrame(fidelity);
    for (std::size_t i = 0; i < frame->channels.size(); ++i) {
      frame->channels[i].position = i % 2 == 1 && random_.OneIn(3) ? 0 : random_.Uniform(-9, 9);
    }
    for (BodyState& body : frame->bodies) {
      if (!random_.OneIn(4)) continue;
      body.p_WB += 1e-3 * Vector3(random_.Uniform(-1, 1), random_.Uniform(-1, 1), random_.Uniform(-1, 1));
    }
    if (random_.OneIn(5)) frame->bodies.back().p_WB += Vector3(0.8, -0.6, 0.05);  // came off
    return frame;
  }

 private:
  Quaternion Tilt(double most_rad) {
    return FromRollPitchYaw(random_.Uniform(-most_rad, most_rad), random_.Uniform(-most_rad, most_rad) / 2,
                            0);
  }
  Shape RandomShape() {
    const int kind = random_.Int(3);
    if (kind == 0) {
      return Box{{random_.Uniform(0.05, 2), random_.Uniform(0.05, 0.3), random_.Uniform(0.1, 1)}};
    }
    if (kind == 1) return Cylinder{random_.Uniform(0.02, 0.3), random_.Uniform(0.1, 1)};
    return Sphere{random_.Uniform(0.02, 0.3)};
  }

  Random random_;
  SampleWorld world_;
};

void CompareAll(Fidelity fidelity, unsigned first_seed) {
  int finite = 0, infinite = 0, inside = 0;
  for (unsigned seed = first_seed; seed < first_seed + 30; ++seed) {
    RandomWorld world(seed);
    const auto frame = world.MakeFrame(fidelity);
    for (int robot = 0; robot < static_cast<int>(frame->scene->robots.size()); ++robot) {
      const auto ranges_m = Distances(*frame, robot);
      const std::vector<double> expected_m = ReferenceDistances(*frame, robot);
      ASSERT_EQ(ranges_m.size(), expected_m.size());
      for (std::size_t i = 0; i < ranges_m.size(); ++i) {
        if (expected_m[i] == kNoHit) {
          ASSERT_EQ(ranges_m[i], kNoHit) << "seed " << seed << " robot " << robot << " sensor " << i;
        } else {
          ASSERT_NEAR(ranges_m[i], expected_m[i], kAgreed_m)
              << "seed " << seed << " robot " << robot << " sensor " << i;
        }
        (expected_m[i] == kNoHit ? infinite : expected_m[i] == 0 ? inside : finite) += 1;
      }
    }
  }
  // Otherwise little was compared.
  EXPECT_GT(finite, 1000);
  EXPECT_GT(infinite, 1000);
  EXPECT_GT(inside, 100);
}

TEST(BruteForceTest, RangesOfRobotsWithWheelsAsBodiesEqualTheReference) {
  CompareAll(Fidelity::kFull, 1);
}

TEST(BruteForceTest, RangesOfRobotsOfOneBodyEqualTheReference) {
  CompareAll(Fidelity::kRolling, 1001);
}

TEST(BruteForceTest, TheRaysForDrawingEndWhereTheReferenceSays) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto frame = RandomWorld(seed).MakeFrame(Fidelity::kFull);
    for (const RaySegment& segment : DistanceRays(*frame, 0)) {
      const Vector3 way = segment.to_W - segment.from_W;
      if (way.norm() == 0) continue;
      const double reference_m = Reference(*frame, 0, {segment.from_W, way.normalized()});
      if (segment.hit) {
        EXPECT_NEAR(way.norm(), reference_m, 1e-7);
      } else {
        EXPECT_GT(reference_m, way.norm() - 1e-7);
      }
    }
  }
}

TEST(BruteForceTest, VisionIsHiddenWhereTheReferenceIs) {
  int seen = 0, hidden = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    RandomWorld world(seed);
    world.AddTargets();
    const auto frame = world.MakeFrame(Fidelity::kRolling);
    const std::vector<Sighting> sightings = SeenTargets(*frame, 0);
    const Pose X_WR = RobotPose(*frame, 0);
    const Vector3 eye_W = X_WR * Vector3(0, 0, frame->scene->robots[0].entry.model->height_m);
    for (std::size_t i = 0; i < frame->scene->targets.size(); ++i) {
      const Vector3 way = frame->scene->targets[i].p_WT - eye_W;
      // The floor hides nothing.
      const bool is_hidden = ReferenceAbove(*frame, 0, {eye_W, way.normalized()}) <= way.norm();
      const bool is_seen = std::any_of(sightings.begin(), sightings.end(), [i](const Sighting& sighting) {
        return sighting.index == static_cast<int>(i);
      });
      EXPECT_NE(is_seen, is_hidden) << "seed " << seed << " target " << i;
      (is_seen ? seen : hidden) += 1;
    }
  }
  EXPECT_GT(seen, 20);
  EXPECT_GT(hidden, 20);
}

}  // namespace
}  // namespace coopdyn
