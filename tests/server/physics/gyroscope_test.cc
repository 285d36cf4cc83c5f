// SPDX-License-Identifier: MIT
// Flywheels of up to 600 rad/s in gimbals, on the floor and in free fall, limp and held by their motors, at
// 1, 5 and 10 ms, against small steps of the exact equations (Runge-Kutta) and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "tests/server/physics/rig.h"

namespace coopdyn {
namespace {

constexpr std::array kSpins_rad_s = {100.0, 200.0, 300.0, 600.0};
constexpr double kHeight_m = 3, kDisc_kg = 1, kAxle_kg = 0.1, kArm_m = 0.1, kAxle_m = 0.05;
constexpr double kAlong = 0.0025, kAcross = 0.00125, kAxle = 1e-4, kFork = 1e-7;  // inertias, kg m²

LinkModel Disc(const char* name, const Vector3& p_R, const Vector3& axis_R) {
  LinkModel disc = Link(name, p_R, kDisc_kg, kAcross);
  disc.inertia_kg_m2 += (kAlong - kAcross) * axis_R;
  disc.collisions.clear();
  return disc;
}

void AddMotor(RobotModel& model, int joint) {
  JointModel& of = model.joints[static_cast<std::size_t>(joint)];
  of.max_effort = 10;
  of.max_velocity = 1000;
  model.actuators = {{"motor", {joint}, BoardModel()}};
}

/// A disc on an axle that points along x from the crossing of a yaw and a pitch hinge.
RobotModel Gimbals(bool is_held) {
  RobotModel model = OnAPost();
  model.links.push_back(Link("fork", {0, 0, kHeight_m}, 0.001, kFork));
  model.links.push_back(Link("axle", {kAxle_m, 0, kHeight_m}, kAxle_kg, kAxle));
  for (const std::size_t link : {1, 2}) model.links[link].collisions.clear();
  model.links.push_back(Disc("disc", {kArm_m, 0, kHeight_m}, Vector3::UnitX()));
  model.joints = {Hinge("yaw", 0, 1, {0, 0, kHeight_m}), Hinge("pitch", 1, 2, {0, 0, kHeight_m}),
                  Hinge("spin", 2, 3, {kArm_m, 0, kHeight_m})};
  model.joints[0].axis_R = Vector3::UnitZ();
  model.joints[2].axis_R = Vector3::UnitX();
  if (is_held) AddMotor(model, 2);
  return model;
}

struct Course {
  double yaw_rad = 0, most_pitch_rad = 0;
};

/// The same by Runge-Kutta. Released at rest, so the momentum about the vertical is 0. `is_held`: the disc
/// keeps its rate relative to the axle, else its rate about its own axis.
Course ExactCourse(double spin_rad_s, bool is_held, double duration_s) {
  constexpr double kPitch = kAcross + kDisc_kg * kArm_m * kArm_m + kAxle + kAxle_kg * kAxle_m * kAxle_m;
  constexpr double kMoment = kG * (kDisc_kg * kArm_m + kAxle_kg * kAxle_m), kStep_s = 1e-4;
  using State = std::array<double, 3>;  // pitch, its rate, yaw
  const auto rates = [&](const State& state) -> State {
    const double c = std::cos(state[0]), s = std::sin(state[0]);
    const double inertia = kPitch * c * c + kAxle * s * s + kFork;
    const double yaw = kAlong * spin_rad_s * s / (inertia + (is_held ? kAlong * s * s : 0));
    const double spin = is_held ? spin_rad_s - yaw * s : spin_rad_s;
    const double turn = (kAxle - kPitch) * s * c * yaw * yaw - kAlong * spin * yaw * c + kMoment * c;
    return {state[1], turn / kPitch, yaw};
  };
  const auto moved = [](const State& from, double dt_s, const State& by) -> State {
    return {from[0] + dt_s * by[0], from[1] + dt_s * by[1], from[2] + dt_s * by[2]};
  };
  State state = {};
  Course course;
  for (int i = 0; i < std::lround(duration_s / kStep_s); ++i) {
    const State a = rates(state), b = rates(moved(state, kStep_s / 2, a)),
                c = rates(moved(state, kStep_s / 2, b)), d = rates(moved(state, kStep_s, c));
    for (std::size_t k = 0; k < 3; ++k) state[k] += kStep_s / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
    course.most_pitch_rad = std::max(course.most_pitch_rad, state[0]);
  }
  course.yaw_rad = state[2];
  return course;
}

class GyroscopeTest : public ::testing::TestWithParam<int> {
 protected:
  void Release(double spin_rad_s, bool is_held) {
    scene_ = PhysicsScene();
    BuildWith(Gimbals(is_held), GetParam(), scene_);
    if (is_held) scene_.setpoints.assign(1, {spin_rad_s, ControlMode::kVelocity});
    auto frame = scene_.Capture();
    frame->bodies[3].w_WB.x() = spin_rad_s;
    scene_.Restore(*frame);
  }

  Course Run(double duration_s) {
    Course course;
    const auto yaw_rad = [&](const Vector3& p_W) { return std::atan2(p_W.y(), p_W.x()); };
    double last_rad = yaw_rad(LinkPose(*scene_.Capture(), 0, 3).p);
    for (int i = 0; i < std::lround(duration_s * 1000 / GetParam()); ++i) {
      scene_.Run(1);
      const Vector3 p_W = LinkPose(*scene_.Capture(), 0, 3).p;
      const double now_rad = yaw_rad(p_W);
      course.yaw_rad += std::remainder(now_rad - std::exchange(last_rad, now_rad), 2 * std::numbers::pi);
      course.most_pitch_rad =
          std::max(course.most_pitch_rad, std::asin(std::clamp((kHeight_m - p_W.z()) / kArm_m, -1.0, 1.0)));
    }
    return course;
  }

  /// The disc's rate about its axis.
  double Spin_rad_s() {
    const BodyState disc = scene_.Capture()->bodies[3];
    return (disc.orientation() * Vector3::UnitX()).dot(disc.w_WB);
  }

  double Energy_j() {
    const auto frame = scene_.Capture();
    double sum_j = 0;
    for (std::size_t i = 1; i < frame->bodies.size(); ++i) {
      const LinkModel& link = scene_.robot_model->links[i];
      const BodyState& body = frame->bodies[i];
      const Vector3 w_B = body.orientation().conjugate() * body.w_WB;
      sum_j += link.mass_kg * (kG * body.p_WB.z() + body.v_WB.squaredNorm() / 2) +
               w_B.dot(link.inertia_kg_m2.cwiseProduct(w_B)) / 2;
    }
    return sum_j;
  }

  PhysicsScene scene_;
};

TEST_P(GyroscopeTest, ALimpWheelInGimbalsFollowsTheExactCourse) {
  constexpr double kDuration_s = 5;
  for (const double spin_rad_s : kSpins_rad_s) {
    SCOPED_TRACE(spin_rad_s);
    Release(spin_rad_s, false);
    const double before_j = Energy_j();
    const Course course = Run(kDuration_s), exact = ExactCourse(spin_rad_s, false, kDuration_s);
    EXPECT_NEAR(course.yaw_rad, exact.yaw_rad, 0.01 * exact.yaw_rad);
    EXPECT_NEAR(course.most_pitch_rad, exact.most_pitch_rad, 0.05 * exact.most_pitch_rad);
    EXPECT_NEAR(Energy_j(), before_j, 1e-3 * kAlong * spin_rad_s * spin_rad_s / 2);
    EXPECT_NEAR(Spin_rad_s(), spin_rad_s, 5e-3 * spin_rad_s);
  }
}

TEST_P(GyroscopeTest, ALimpWheelNutatesForAMinuteAsAtFirst) {
  for (const double spin_rad_s : kSpins_rad_s) {
    SCOPED_TRACE(spin_rad_s);
    Release(spin_rad_s, false);
    const double first_rad = Run(2).most_pitch_rad;
    Run(56);
    EXPECT_NEAR(Run(2).most_pitch_rad, first_rad, 0.05 * first_rad);
  }
}

TEST_P(GyroscopeTest, AMotorHoldsAWheelInGimbalsOnTheExactCourse) {
  constexpr double kDuration_s = 5;
  for (const double spin_rad_s : kSpins_rad_s) {
    SCOPED_TRACE(spin_rad_s);
    Release(spin_rad_s, true);
    const Course course = Run(kDuration_s), exact = ExactCourse(spin_rad_s, true, kDuration_s);
    EXPECT_NEAR(course.yaw_rad, exact.yaw_rad, 0.02 * exact.yaw_rad);
    EXPECT_NEAR(course.most_pitch_rad, exact.most_pitch_rad, 0.25 * exact.most_pitch_rad);
    Run(56);
    EXPECT_LT(Run(2).most_pitch_rad, 1.25 * exact.most_pitch_rad);
  }
}

// The axis of a craft with a wheel turns about the angular momentum, which stays what it is.
TEST_P(GyroscopeTest, ACraftWithAHeldWheelKeepsItsAngularMomentum) {
  for (const double spin_rad_s : kSpins_rad_s) {
    SCOPED_TRACE(spin_rad_s);
    scene_ = PhysicsScene();
    RobotModel model = OnAPost();
    model.fixed_base = false;
    constexpr double kCraft_kg_m2 = 0.005;
    model.links[0].inertia_kg_m2.setConstant(kCraft_kg_m2);
    model.links.push_back(Disc("wheel", {0, 0, kHeight_m}, Vector3::UnitX()));
    model.joints = {Hinge("spin", 0, 1, {0, 0, kHeight_m})};
    model.joints[0].axis_R = Vector3::UnitX();
    AddMotor(model, 0);
    scene_.SetGravity(0);
    BuildWith(model, GetParam(), scene_);
    scene_.setpoints.assign(1, {spin_rad_s, ControlMode::kVelocity});
    auto frame = scene_.Capture();
    constexpr double kTilt_rad_s = 3;
    for (BodyState& body : frame->bodies) body.w_WB.z() = kTilt_rad_s;
    frame->bodies[1].w_WB.x() = spin_rad_s;
    scene_.Restore(*frame);
    const auto momentum = [&] {
      const auto now = scene_.Capture();
      Vector3 sum_W = Vector3::Zero();
      for (std::size_t i = 0; i < 2; ++i) {
        const BodyState& body = now->bodies[i];
        const Quaternion q = body.orientation();
        sum_W += q * scene_.robot_model->links[i].inertia_kg_m2.cwiseProduct(q.conjugate() * body.w_WB);
      }
      return sum_W;
    };
    const Vector3 before_W = momentum();
    scene_.RunFor(10);
    const Vector3 after_W = momentum(), w_W = scene_.Capture()->bodies[0].w_WB;
    EXPECT_LT((after_W - before_W).norm(), 0.02 * before_W.norm());
    EXPECT_LT(w_W.norm(), 1.1 * kTilt_rad_s);
  }
}

// A top whose motor holds its wheel, on a ball of 1 cm that slides on ice.
TEST_P(GyroscopeTest, ATopOnTheFloorPrecessesAtItsRate) {
  for (const double spin_rad_s : {300.0, 600.0}) {
    SCOPED_TRACE(spin_rad_s);
    scene_ = PhysicsScene();
    RobotModel model = OnAPost();
    model.fixed_base = false;
    constexpr double kBall_m = 0.01, kTip_kg = 0.05, kTip = 2e-5, kTilt_rad = 0.4;
    model.links = {Link("tip", {0, 0, kBall_m}, kTip_kg, kTip),
                   Disc("wheel", {0, 0, kBall_m + kArm_m}, Vector3::UnitZ())};
    model.links[0].collisions = {{Sphere{kBall_m}, {}, {}, 1, false}};
    model.joints = {Hinge("spin", 0, 1, {0, 0, kBall_m + kArm_m})};
    model.joints[0].axis_R = Vector3::UnitZ();
    AddMotor(model, 0);
    scene_.step_length = GetParam() * 1'000'000;
    scene_.robot_model = std::make_shared<const RobotModel>(model);
    const Quaternion q(Eigen::AngleAxisd(kTilt_rad, Vector3::UnitY()));
    const Vector3 ball_R(0, 0, kBall_m);
    scene_.SetFloorFriction(0).AddRobot(Pose{ball_R - q * ball_R, q});
    scene_.Build();
    ASSERT_EQ(scene_.diagnostics().ToString(), "");
    scene_.setpoints.assign(1, {spin_rad_s, ControlMode::kVelocity});
    auto frame = scene_.Capture();
    frame->bodies[1].w_WB = spin_rad_s * (q * Vector3::UnitZ());
    scene_.Restore(*frame);
    const auto axis_W = [&] { return Vector3(LinkPose(*scene_.Capture(), 0, 0).q * Vector3::UnitZ()); };
    double angle_rad = 0, last_rad = 0, most_rad = 0;
    constexpr double kDuration_s = 10;
    for (int i = 0; i < kDuration_s * 1000 / GetParam(); ++i) {
      scene_.Run(1);
      const Vector3 now_W = axis_W();
      const double now_rad = std::atan2(now_W.y(), now_W.x());
      angle_rad += std::remainder(now_rad - std::exchange(last_rad, now_rad), 2 * std::numbers::pi);
      most_rad = std::max(most_rad, std::acos(now_W.z()));
    }
    constexpr double kWeight_nm = kG * kDisc_kg * kArm_m;
    const double rate_rad_s = kWeight_nm / (kAlong * spin_rad_s);
    EXPECT_NEAR(angle_rad / kDuration_s, rate_rad_s, 0.05 * rate_rad_s);
    EXPECT_LT(most_rad, kTilt_rad + 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(Steps, GyroscopeTest, ::testing::Values(1, 5, 10),
                         [](const auto& step) { return std::to_string(step.param) + "ms"; });

}  // namespace
}  // namespace coopdyn
