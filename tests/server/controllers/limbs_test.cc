// SPDX-License-Identifier: MIT
// Loaded controllers of robots with limbs, without physics: joints reach their set-points immediately.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/server/controllers/swarm.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

using PuppetOptions = std::vector<std::pair<std::string, double>>;

struct Limbed {
  const char* sample;
  const char* type;
};
constexpr Limbed kLimbed[] = {{"reach", "lwa"},      {"reach", "irb120"},   {"trot", "quadruped"},
                              {"tripod", "hexapod"}, {"squat", "humanoid"}, {"walk", "humanoid"}};

/// A robot of robots/ at its body's pose, and its controller.
class Puppet {
 public:
  Puppet(const std::string& type, const std::string& file, bool in_process = true, PuppetOptions options = {})
      : pool_(1), host_(TestOptions(in_process), clock_, NullLogger(), pool_) {
    Scenario scenario = *Good("[FLOOR]\n[ROBOT_1]\ntype " + type + "\nname r1\nposition 0 0\n");
    ControllerChoice& controller = scenario.robots[0].controller;
    const std::size_t slash = file.rfind('/');
    controller.name = file.substr(slash + 1, file.size() - slash - 4);
    controller.file = file;
    controller.options = std::move(options);
    auto frame = std::make_shared<Frame>();
    frame->scene = MakeScene(std::make_shared<Scenario>(scenario));
    frame->bodies.resize(frame->scene->body_ids.size());
    frame->channels.resize(frame->scene->channels.size());
    frame->commanded.resize(1);
    frame_ = frame;
    Lie({}, Vector3::Zero(), Vector3::Zero());
    host_.Configure(frame_);
  }

  const RobotModel& model() const { return *frame_->scene->robots[0].entry.model; }
  ControllerHost& host() { return host_; }
  const FramePtr& frame() const { return frame_; }
  const std::vector<SentMessage>& messages() const { return messages_; }

  /// Places R; v_R and w_R are along its axes.
  void Lie(const Pose& X_WR, const Vector3& v_R, const Vector3& w_R) {
    const std::shared_ptr<Frame> frame = Copy();
    const SceneRobot& robot = frame->scene->robots[0];
    BodyState& body = frame->bodies[static_cast<std::size_t>(robot.first_body)];
    const Quaternion q = robot.axes_of_R ? X_WR.q : X_WR.q * robot.X_BR.q.conjugate();
    body.q_WB = {q.w(), q.x(), q.y(), q.z()};
    body.p_WB = X_WR.p - q * robot.X_BR.p;
    body.w_WB = X_WR.q * w_R;
    body.v_WB = X_WR.q * v_R + body.w_WB.cross(body.p_WB - X_WR.p);
    frame_ = frame;
  }

  const std::vector<Setpoint>& Step() {
    setpoints_.assign(frame_->channels.size(), {});
    messages_.clear();
    host_.Step(frame_, setpoints_, messages_);
    const std::shared_ptr<Frame> next = Copy();
    ++next->step;
    next->time += next->step_length;
    for (std::size_t i = 0; i < setpoints_.size(); ++i) {
      if (setpoints_[i].mode == ControlMode::kDirect) next->channels[i].position = setpoints_[i].reference;
    }
    frame_ = next;
    return setpoints_;
  }

  /// Continues at `frame` with the state saved there.
  bool Restore(const FramePtr& frame, std::span<const std::byte> saved) {
    frame_ = frame;
    return host_.Restore(frame, saved);
  }

  /// The set-points by joint name.
  double At(const std::string& joint) const {
    const std::vector<Channel>& channels = frame_->scene->channels;
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (model().joints[static_cast<std::size_t>(channels[i].joint)].name == joint)
        return setpoints_[i].reference;
    }
    ADD_FAILURE() << joint;
    return 0;
  }

  /// Rotation and displacement of a humanoid's foot at the last set-points, relative to its pose with all
  /// joints at 0.
  Pose Foot(const std::string& side) const {
    Pose X;
    for (const char* joint : {"hip_pitch", "hip_roll", "hip_yaw", "knee", "ankle_pitch", "ankle_roll"}) {
      const auto of = std::ranges::find(model().joints, side + joint, &JointModel::name);
      const Quaternion turn(Eigen::AngleAxisd(At(of->name), of->axis_R));
      X = X * Pose{of->p_RJ - turn * of->p_RJ, turn};
    }
    const auto ankle = std::ranges::find(model().joints, side + "ankle_roll", &JointModel::name);
    return {X.p + X.q * ankle->p_RJ - ankle->p_RJ, X.q};
  }

 private:
  std::shared_ptr<Frame> Copy() const {
    auto frame = std::make_shared<Frame>();
    frame->scene = frame_->scene;
    frame->step = frame_->step;
    frame->time = frame_->time;
    frame->bodies = frame_->bodies;
    frame->channels = frame_->channels;
    frame->commanded = frame_->commanded;
    return frame;
  }

  SteadyClock clock_;
  WorkerPool pool_;
  ControllerHost host_;
  FramePtr frame_;
  std::vector<Setpoint> setpoints_;
  std::vector<SentMessage> messages_;
};

TEST(ControllerReadingsTest, MotionOfTheBodyAlongItsOwnAxes) {
  for (const bool in_process : {false, true}) {
    Puppet puppet("minibot", TestPlugin("mirror"), in_process, {{"what", 10}});
    puppet.Lie({{5, 6, 0.4}, FromRollPitchYaw(0.1, 0.2, 0.3)}, {1, 2, 3}, {0.5, -0.6, 0.7});
    puppet.Step();
    ASSERT_EQ(puppet.messages().size(), 1u);
    const auto& values = puppet.messages()[0].message.values;
    EXPECT_THAT(std::vector<double>(values.begin(), values.begin() + 8),
                ElementsAre(DoubleNear(0.4, 1e-12), DoubleNear(0.1, 1e-12), DoubleNear(0.2, 1e-12),
                            DoubleNear(1, 1e-12), DoubleNear(2, 1e-12), DoubleNear(3, 1e-12),
                            DoubleNear(0.5, 1e-12), DoubleNear(-0.6, 1e-12)));
  }
}

TEST(LimbControllersTest, KeepJointsWithinTheirStopsAndMoveThem) {
  for (const Limbed& of : kLimbed) {
    SCOPED_TRACE(std::string(of.sample) + " " + of.type);
    Puppet puppet(of.type, Sample(of.sample));
    double farthest = 0;
    for (int i = 0; i < 400; ++i) {
      const std::vector<Setpoint>& setpoints = puppet.Step();
      for (std::size_t k = 0; k < setpoints.size(); ++k) {
        const Channel& channel = puppet.frame()->scene->channels[k];
        const JointModel& joint = puppet.model().joints[static_cast<std::size_t>(channel.joint)];
        ASSERT_EQ(setpoints[k].mode, ControlMode::kDirect) << joint.name;
        ASSERT_GE(setpoints[k].reference, joint.lower) << joint.name;
        ASSERT_LE(setpoints[k].reference, joint.upper) << joint.name;
        farthest = std::max(farthest, std::abs(setpoints[k].reference));
      }
    }
    EXPECT_TRUE(puppet.host().TakeStopped().empty());
    EXPECT_GT(farthest, 0.1);
  }
}

TEST(LimbControllersTest, CommandTheSameInAProcessOfTheirOwn) {
  for (const Limbed& of : kLimbed) {
    SCOPED_TRACE(std::string(of.sample) + " " + of.type);
    Puppet inside(of.type, Sample(of.sample)), child(of.type, Sample(of.sample), false);
    for (int i = 0; i < 150; ++i) ASSERT_TRUE(inside.Step() == child.Step()) << i;
  }
}

TEST(LimbControllersTest, GoOnFromASavedState) {
  for (const Limbed& of : kLimbed) {
    SCOPED_TRACE(std::string(of.sample) + " " + of.type);
    Puppet puppet(of.type, Sample(of.sample)), other(of.type, Sample(of.sample));
    for (int i = 0; i < 170; ++i) puppet.Step();
    ASSERT_TRUE(other.Restore(puppet.frame(), puppet.host().Save()));
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(puppet.Step() == other.Step()) << i;
  }
}

TEST(LimbControllersTest, RefuseARobotWithoutTheirJoints) {
  const std::map<std::string, std::string> reasons = {{"reach", "the robot needs an arm"},
                                                      {"trot", "the robot has no driven joint front_left_"},
                                                      {"tripod", "the robot has no driven joint front_left_"},
                                                      {"squat", "the robot has no driven joint left_hip_"},
                                                      {"walk", "the robot has no driven joint left_hip_"}};
  for (const auto& [sample, why] : reasons) {
    Puppet puppet("minibot", Sample(sample));
    const std::vector<StoppedController> stopped = puppet.host().TakeStopped();
    ASSERT_EQ(stopped.size(), 1u) << sample;
    EXPECT_THAT(stopped[0].why, HasSubstr(why));
  }
}

TEST(LimbControllersTest, ASquatSinksByItsDepthOverLevelFeet) {
  Puppet puppet("humanoid", Sample("squat"), true, {{"depth", 0.12}, {"period", 2}, {"wait", 0}});
  double highest_m = 0;
  for (int i = 0; i < 200; ++i) {
    puppet.Step();
    for (const char* side : {"left_", "right_"}) {
      const Pose X = puppet.Foot(side);
      EXPECT_LT(X.q.angularDistance(Quaternion::Identity()), 1e-7);
      EXPECT_NEAR(X.p.x(), 0, 1e-7);
      EXPECT_NEAR(X.p.y(), 0, 1e-7);
      highest_m = std::max(highest_m, X.p.z());
    }
  }
  EXPECT_NEAR(highest_m, 0.12, 1e-7) << "the hips are that much nearer to the feet";
}

TEST(LimbControllersTest, AnkleAnswersALean) {
  for (const char* sample : {"squat", "walk"}) {
    Puppet upright("humanoid", Sample(sample)), leaning("humanoid", Sample(sample));
    leaning.Lie({{0, 0, 0}, FromRollPitchYaw(0.03, 0.05, 0)}, Vector3::Zero(), Vector3::Zero());
    upright.Step();
    leaning.Step();
    EXPECT_GT(leaning.At("left_ankle_pitch"), upright.At("left_ankle_pitch")) << sample;
    EXPECT_GT(leaning.At("left_ankle_roll"), upright.At("left_ankle_roll")) << sample;
  }
}

TEST(LimbControllersTest, AWalkLiftsOneFootAfterTheOtherAndKeepsThemLevel) {
  constexpr int kSteps = 6;
  Puppet puppet("humanoid", Sample("walk"), true,
                {{"steps", kSteps}, {"length", 0.05}, {"period", 1}, {"lift", 0.03}, {"wait", 1}});
  std::string lifted;  // the lifted foot after each change
  for (int i = 0; i < 100 * (kSteps + 3); ++i) {
    puppet.Step();
    const Pose left = puppet.Foot("left_"), right = puppet.Foot("right_");
    for (const Pose& foot : {left, right}) {
      ASSERT_LT(foot.q.angularDistance(Quaternion::Identity()), 1e-7) << i;
    }
    const double higher_m = left.p.z() - right.p.z();
    const char now = higher_m > 0.029 ? 'l' : higher_m < -0.029 ? 'r' : ' ';
    if (now != ' ' && (lifted.empty() || lifted.back() != now)) lifted += now;
  }
  EXPECT_EQ(lifted, "rlrlrl");
  EXPECT_NEAR(puppet.Foot("left_").p.x(), puppet.Foot("right_").p.x(), 1e-7) << "it stands at the end";
}

}  // namespace
}  // namespace coopdyn
