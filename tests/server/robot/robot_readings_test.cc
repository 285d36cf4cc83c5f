// SPDX-License-Identifier: MIT
// Attached readings and subscriptions: their content and order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/server/robot/robot_fixture.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(RobotModuleTest, AttachedReadingsStandBeforeTimeAndStepWithTheirLengths) {
  world_.StepInline();
  auto one = Connect(kMotors, 0), two = Connect(kMotors, 1);
  EXPECT_EQ(one->Ask("attach distance pose target").error, 0);
  one->Send("set_velocity 0.2 0");
  two->Send("ready");
  thread_.Run();
  const Message reply = one->received.back();
  EXPECT_THAT(reply.params, ElementsAre(1, 3, 5, 6));
  ASSERT_EQ(reply.data.size(), 3u + 5 + 6 + 2);
  EXPECT_DOUBLE_EQ(reply.data[3], 0.01) << "x of the frame of step 1";
  EXPECT_DOUBLE_EQ(reply.data[8], 2.99) << "the first target from there";
  EXPECT_EQ(StepOf(reply), 1);
  EXPECT_EQ(one->Ask("get_time").params, reply.params);
  EXPECT_EQ(one->received.back().data, reply.data);
  EXPECT_THAT(one->Ask("get_wheels").data, testing::SizeIs(6)) << "other replies are as they were";
  EXPECT_EQ(one->Ask("attach").error, 0);
  EXPECT_THAT(one->Ask("get_time").params, ElementsAre(1));
}

TEST_F(RobotModuleTest, ReadyOfASpectatorCarriesItsAttachments) {
  auto watcher = Connect(kPose, 1);
  watcher->Ask("attach motors");
  watcher->Send("ready");
  world_.Step();
  thread_.Run();
  EXPECT_THAT(watcher->received.back().params, ElementsAre(1, 4));
  EXPECT_THAT(watcher->received.back().data, testing::SizeIs(6));
}

TEST_F(RobotModuleTest, AttachOfAnUnknownModuleListsThoseThereAreAndChangesNothing) {
  auto client = Connect(kPose);
  client->Ask("attach motors");
  const Message reply = client->Ask("attach distance laser");
  EXPECT_EQ(reply.error, 10);
  EXPECT_THAT(reply.text, HasSubstr("motors distance target pose"));
  EXPECT_EQ(client->Ask("attach pose pose").error, 2);
  EXPECT_THAT(client->Ask("get_time").params, ElementsAre(1, 4));
}

TEST_F(RobotModuleTest, SubscriptionPushesTheFirstReadingEverySoManySteps) {
  auto client = Connect(kMotors);
  client->Ask("subscribe 2");
  for (int i = 0; i < 5; ++i) world_.Step();
  thread_.Run();
  const auto pushes = client->pushes();
  ASSERT_EQ(pushes.size(), 2u);
  EXPECT_EQ(pushes[0].command, -12);
  EXPECT_EQ(StepOf(pushes[0]), 2);
  EXPECT_EQ(StepOf(pushes[1]), 4);
  EXPECT_EQ(pushes[0].data.size(), 6u);
}

TEST_F(RobotModuleTest, SubscriptionsToSeveralReadingsEndOneByOne) {
  auto client = Connect(kPose);
  client->Ask("subscribe");
  client->Ask("subscribe 1 get_pose_3d");
  world_.Step();
  thread_.Run();
  EXPECT_EQ(client->pushes().size(), 2u);
  client->Ask("unsubscribe get_pose_3d");
  world_.Step();
  thread_.Run();
  EXPECT_EQ(client->pushes().size(), 3u);
  EXPECT_EQ(client->pushes().back().command, -40);
  client->Ask("unsubscribe");
  world_.Step();
  EXPECT_EQ(thread_.posted(), 0u) << "nobody is woken for nothing";
}

TEST_F(RobotModuleTest, ClosedSubscriberIsForgotten) {
  auto client = Connect(kPose);
  client->Ask("subscribe");
  client->CloseNow();
  world_.Step();
  EXPECT_EQ(thread_.posted(), 0u);
}

TEST_F(RobotModuleTest, FramesLostToASlowThreadAreTold) {
  auto client = Connect(kPose);
  client->Ask("subscribe");
  for (int i = 0; i < 70; ++i) world_.Step();
  thread_.Run();
  const auto pushes = client->pushes();
  ASSERT_EQ(pushes.size(), 64u);
  EXPECT_EQ(pushes[0].text, "dropped 6");
  EXPECT_EQ(StepOf(pushes[0]), 7);
  EXPECT_EQ(pushes[1].text, "");
}

TEST_F(RobotModuleTest, AReadingThatSeveralWantIsOneAndIsMadeWhenSomebodyTakesIt) {
  auto one = Connect(kDistance), two = Connect(kDistance);
  for (const auto& client : {one.get(), two.get()}) {
    client->Ask("subscribe");
    client->reads = false;
  }
  world_.Step();
  thread_.Run();
  ASSERT_EQ(one->unread.size(), 1u);
  EXPECT_EQ(one->unread, two->unread);
  const FramePtr frame = world_.frames.Latest();
  EXPECT_EQ(frame->cache, nullptr) << "nothing has been measured";
  EXPECT_EQ(StepOf(*one->unread[0]->message()), 1);
  EXPECT_NE(frame->cache, nullptr);
}

class LargeWorldTest : public RobotModuleTest {
 protected:
  LargeWorldTest() : RobotModuleTest(300) {}
};

TEST_F(LargeWorldTest, ALargeFrameIsNotKeptForWhoDoesNotRead) {
  auto client = Connect(kPose);
  client->Ask("subscribe");
  client->reads = false;
  world_.Step();
  thread_.Run();
  const std::weak_ptr<const Frame> frame = world_.frames.Latest();
  world_.Step();
  thread_.Run();
  EXPECT_TRUE(frame.expired());
  ASSERT_EQ(client->unread.size(), 2u);
  EXPECT_EQ(StepOf(*client->unread[0]->message()), 1);
}

TEST_F(RobotModuleTest, AClientThatIsGoneIsNotAnsweredButItsCommandsCount) {
  world_.StepInline();
  auto client = Connect(kMotors), other = Connect(kMotors, 1);
  client->Ask("attach distance");
  client->EndOutput();
  EXPECT_TRUE(client->Ask("get_wheels").data.empty());
  client->Send("set_velocity 0.2 0");
  other->Send("ready");
  thread_.Run();
  EXPECT_FALSE(client->is_waiting());
  EXPECT_TRUE(client->received.back().data.empty());
  EXPECT_EQ(world_.frames.Latest()->cache, nullptr) << "nothing has been measured";
  EXPECT_EQ(SetpointOf(*world_.frames.Latest(), 0)[0], 2.0);
}

TEST_F(RobotModuleTest, PushesOfAStepPrecedeEveryReplyThatReportsIt) {
  std::mt19937 random(5);
  world_.StepInline();
  std::vector<std::unique_ptr<FakeClient>> clients;
  for (int robot : {0, 1}) {
    for (int module : {kMotors, kPose}) {
      clients.push_back(Connect(module, robot));
      clients.back()->Ask("subscribe");
    }
  }
  for (int i = 0; i < 3000; ++i) {
    switch (random() % 6) {
      case 0:
        thread_.Run();
        break;
      case 1:
        SetMode(random() % 2 ? Mode::kRealtime : Mode::kLockstep);
        break;
      case 2:
        if (world_.board.mode() != Mode::kRealtime) break;
        world_.Publish();
        if (FakeClient& reader = *clients[random() % 4]; !reader.is_waiting()) reader.Send("get_time");
        world_.Finish();
        break;
      default:
        if (FakeClient& client = *clients[random() % 4]; !client.is_waiting()) {
          client.Send(random() % 2 ? "ready" : "get_time");
        }
    }
  }
  thread_.Run();
  int replies = 0, pushes = 0;
  for (const auto& client : clients) {
    double pushed = 0;
    for (const Message& message : client->received) {
      if (message.command < 0) {
        EXPECT_EQ(StepOf(message), pushed + 1) << "in order, none lost, none twice";
        pushed = StepOf(message);
        ++pushes;
      } else if (message.command != command::kSubscribe) {
        EXPECT_LE(StepOf(message), pushed);
        ++replies;
      }
    }
  }
  EXPECT_GT(replies, 500);
  EXPECT_GT(pushes, 500);
}

}  // namespace
}  // namespace coopdyn
