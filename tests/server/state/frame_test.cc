// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "server/state/frame_board.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

/// A body with link frame `X_WL` and inertial frame `X_LI`.
BodyState BodyAt(const Pose& X_WL, const Pose& X_LI) {
  const Pose X_WI = X_WL * X_LI;
  BodyState body;
  body.p_WB = X_WI.p;
  body.q_WB = {X_WI.q.w(), X_WI.q.x(), X_WI.q.y(), X_WI.q.z()};
  return body;
}

void ExpectSame(const Pose& a, const Pose& b) {
  EXPECT_LT((a.p - b.p).norm(), 1e-12);
  EXPECT_LT(a.q.angularDistance(b.q), 1e-7);
}

class FramePoses : public testing::Test {
 protected:
  FramePoses() {
    auto model = std::make_shared<RobotModel>();
    model->links.resize(2);
    for (std::size_t k = 0; k < 2; ++k) {
      const double s = 0.1 * static_cast<double>(k + 1);
      model->links[k].X_RL = {{s, -s, 2 * s}, FromRollPitchYaw(s, 2 * s, -s)};
      model->links[k].X_LI = {{-s, 3 * s, s}, FromRollPitchYaw(-s, s, 3 * s)};
    }
    auto scenario = std::make_shared<Scenario>();
    RobotEntry entry;
    entry.name = "robot1";
    entry.model = model;
    scenario->robots = {entry};
    scenario->objects = {{"WALL", Sphere{1}, {{7, 8, 9}, FromRollPitchYaw(1, 0, 0)}, 0, {}, 1, {}},
                         {"CRATE", Sphere{1}, {}, 1, {}, 1, {}}};
    frame.scene = MakeScene(scenario);
    frame.bodies = {BodyAt(X_WO, {}), BodyAt(X_WR * model->links[0].X_RL, model->links[0].X_LI),
                    BodyAt(X_WR * model->links[1].X_RL, model->links[1].X_LI)};
    frame.channels.resize(frame.scene->channels.size());
  }
  const Pose X_WO{{4, 5, 6}, FromRollPitchYaw(0.3, -0.2, 2)};
  const Pose X_WR{{1, 2, 3}, FromRollPitchYaw(0.1, 0.2, 1)};
  Frame frame;
};

TEST_F(FramePoses, RobotPoseIsOfTheFrameUnderTheAxle) {
  ExpectSame(RobotPose(frame, 0), X_WR);
}

TEST_F(FramePoses, LinkPoseIsOfTheLinkAndNotOfItsCentreOfMass) {
  for (int k = 0; k < 2; ++k) {
    ExpectSame(LinkPose(frame, 0, k),
               X_WR * frame.scene->robots[0].entry.model->links[static_cast<std::size_t>(k)].X_RL);
  }
}

/// One body for chassis and wheels, whose centre of mass is not R's origin.
class OneBodyPoses : public testing::Test {
 protected:
  OneBodyPoses() {
    auto model = std::make_shared<RobotModel>();
    model->links.resize(3);
    model->links[0].mass_kg = 3;
    model->links[0].X_LI.p = {0.04, 0, 0.1};
    for (std::size_t k = 1; k < 3; ++k) {
      model->links[k].mass_kg = 0.5;
      model->links[k].X_RL = {{0, k == 1 ? 0.1 : -0.1, 0.05}, FromRollPitchYaw(-1.5707963267948966, 0, 0)};
    }
    model->joints = {{.name = "left", .child = 1, .p_RJ = {0, 0.1, 0.05}, .max_effort = 1},
                     {.name = "right", .child = 2, .p_RJ = {0, -0.1, 0.05}, .max_effort = 1}};
    model->actuators = {{"motors", {0, 1}, DriveModel{0.05, 0.2, 10, 1}}};
    auto scenario = std::make_shared<Scenario>();
    RobotEntry entry;
    entry.model = model;
    entry.fidelity = Fidelity::kRolling;
    scenario->robots = {entry, entry};
    frame.scene = MakeScene(scenario);
    for (int i = 0; i < 2; ++i)
      frame.bodies.push_back(BodyAt(X_WR, {{0.03, 0, 0.0875}, Quaternion::Identity()}));
    frame.channels.resize(frame.scene->channels.size());
  }
  const Pose X_WR{{1, 2, 3}, FromRollPitchYaw(0.1, 0.2, 1)};
  Frame frame;
};

TEST_F(OneBodyPoses, ARobotHasOneBodyAtItsCentreOfMass) {
  EXPECT_EQ(frame.scene->robots[1].first_body, 1);
  EXPECT_EQ(frame.scene->robots[1].body_count, 1);
  EXPECT_EQ(frame.scene->body_ids.size(), 2u);
  ExpectSame(RobotPose(frame, 1), X_WR);
}

TEST_F(OneBodyPoses, LinksStandWhereTheModelSaysAndWheelsTurnAboutTheirAxles) {
  const RobotModel& model = *frame.scene->robots[0].entry.model;
  for (int k = 0; k < 3; ++k) {
    ExpectSame(LinkPose(frame, 0, k), X_WR * model.links[static_cast<std::size_t>(k)].X_RL);
  }
  SetTurned(frame, 0, {0.4, -20}, {});
  ExpectSame(LinkPose(frame, 0, 0), X_WR * model.links[0].X_RL);
  // Forward about +y, seen in the wheel: about its own axis, which is the axle.
  ExpectSame(LinkPose(frame, 0, 1),
             X_WR * model.links[1].X_RL *
                 Pose{Vector3::Zero(), Quaternion(Eigen::AngleAxisd(0.4, Vector3::UnitZ()))});
  EXPECT_LT((LinkPose(frame, 0, 2).p - X_WR * Vector3(0, -0.1, 0.05)).norm(), 1e-12);
}

TEST_F(OneBodyPoses, AWheelOfUnknownAngleStandsAsInTheModel) {
  const Pose X_WL = LinkPose(frame, 0, 1);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  SetTurned(frame, 0, {kNan, kNan}, {});
  ExpectSame(LinkPose(frame, 0, 1), X_WL);
}

TEST_F(FramePoses, ObjectPoseIsOfTheCentreWhetherItMovesOrNot) {
  ExpectSame(ObjectPose(frame, frame.scene->objects[0]), frame.scene->objects[0].object.X_WO);
  ExpectSame(ObjectPose(frame, frame.scene->objects[1]), X_WO);
}

TEST(FrameBoard, IsEmptyBeforeTheFirstFrame) {
  EXPECT_EQ(FrameBoard().Latest(), nullptr);
}

TEST(FrameBoard, GivesTheNewestFrameAndLetsTheOldOneGo) {
  FrameBoard board;
  auto first = std::make_shared<const Frame>();
  const std::weak_ptr<const Frame> old = first;
  board.Publish(std::move(first));
  const auto second = std::make_shared<const Frame>();
  board.Publish(second);
  EXPECT_EQ(board.Latest(), second);
  EXPECT_TRUE(old.expired());
}

TEST(FrameBoard, ReaderNeverSeesTimeGoBackNorHalfAFrame) {
  FrameBoard board;
  constexpr std::uint64_t kFrames = 2000;
  std::thread writer([&] {
    for (std::uint64_t k = 1; k <= kFrames; ++k) {
      auto frame = std::make_shared<Frame>();
      frame->step = k;
      frame->channels.resize(50);
      for (ChannelState& channel : frame->channels) channel.position = static_cast<double>(k);
      board.Publish(std::move(frame));
    }
  });
  std::uint64_t last = 0;
  while (last < kFrames) {
    const FramePtr frame = board.Latest();
    if (frame == nullptr) continue;
    EXPECT_GE(frame->step, last);
    last = frame->step;
    for (const ChannelState& channel : frame->channels) {
      ASSERT_EQ(channel.position, static_cast<double>(frame->step));
    }
  }
  writer.join();
}

}  // namespace
}  // namespace coopdyn
