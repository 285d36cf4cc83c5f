// SPDX-License-Identifier: MIT
// A program ends its connection, and another one takes the robot immediately, while the robot's thread is
// busy and has not read the end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "held_thread.h"
#include "server/net/listener.h"
#include "server/robot/robot.h"
#include "test_client.h"
#include "tests/server/devices/small_world.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;

class RobotOwnerTest : public testing::TestWithParam<Mode> {
 protected:
  RobotOwnerTest() {
    world_.board.SetMode(GetParam(), 0);
    EXPECT_EQ(robot_.Listen(0, ListenAddresses("127.0.0.1"), 0), "");
    EXPECT_TRUE(robot_.Register());
  }

  /// A client that owns the robot.
  TestClient Owner(TestClient client) {
    client.Send("claim\n");
    EXPECT_THAT(client.Line(), HasSubstr("0 \"\" 7"));
    return client;
  }
  TestClient Connect() { return TestClient::Connect(robot_.port(0)); }
  TestClient ConnectLocal() {
    auto [ours, theirs] = SocketPair();
    names_.Find("/robot1/motors")->adopt(theirs.Release(), "", {"pair", true}, nullptr);
    return TestClient(std::move(ours));
  }
  /// Whether a team can claim the robot as soon as the end has arrived.
  bool ATeamTakesIt() {
    const std::vector<SlotId> slots = {world_.board.FindSlot("robot1")};
    return Eventually([&] { return world_.board.ClaimAll(slots, team_).error == Error::kOk; });
  }

  SteadyClock clock_;
  ImageBoard images_;
  NameTable names_;
  NetServices net_{NullLogger(), clock_};
  ConnectionRoster roster_;
  TokenGuard guard_{"", false};
  SmallWorld world_{1};
  RobotServices services_{world_.board, world_.frames, world_.edits, images_, names_,
                          net_,         roster_,       guard_,       clock_,  "1.2.3"};
  IoThread thread_{"robot-1", NullLogger()};
  Robot robot_{world_.frames.Latest()->scene->robots[0].entry, services_, thread_};
  const Client team_{100'000, "flock", "127.0.0.1:5", false, true};
};

TEST_P(RobotOwnerTest, WhoHasClosedIsInNobodysWay) {
  TestClient owner = Owner(Connect());
  const HeldThread busy(thread_);
  owner.Close();
  EXPECT_TRUE(ATeamTakesIt());
}

TEST_P(RobotOwnerTest, WhoHasClosedALocalSocketIsInNobodysWay) {
  TestClient owner = Owner(ConnectLocal());
  const HeldThread busy(thread_);
  owner.Close();
  EXPECT_TRUE(ATeamTakesIt());
}

TEST_P(RobotOwnerTest, WhoWasKilledIsInNobodysWay) {
  TestClient owner = Owner(Connect());
  const HeldThread busy(thread_);
  owner.Send("get_limits\n");
  owner.Reset();
  EXPECT_TRUE(ATeamTakesIt());
}

TEST_P(RobotOwnerTest, WhoHasClosedBehindUnreadRequestsIsInNobodysWayAndTakesNothingBack) {
  TestClient owner = Owner(Connect());
  {
    const HeldThread busy(thread_);
    owner.Send("set_velocity 0.1 0\nclaim\n");
    owner.EndInput();
    EXPECT_TRUE(ATeamTakesIt());
  }
  EXPECT_THAT(owner.Line(), HasSubstr("driven by flock"));
  EXPECT_THAT(owner.Line(), HasSubstr("driven by flock"));
  EXPECT_EQ(owner.Rest(), "");
  EXPECT_EQ(world_.board.Owners()[0].id, team_.id);
}

TEST_P(RobotOwnerTest, ARequestThatIsReadBeforeTheEndIsNotRefused) {
  TestClient owner = Owner(ConnectLocal()), next = Connect();
  next.Send("ping\n");
  next.Line();
  {
    const HeldThread busy(thread_);
    next.Send("claim\n");
    owner.Close();  // arrives second, and is read second
  }
  EXPECT_THAT(next.Line(), HasSubstr("0 \"\" 7"));
}

INSTANTIATE_TEST_SUITE_P(InEveryMode, RobotOwnerTest,
                         testing::Values(Mode::kLockstep, Mode::kRealtime, Mode::kFree));

}  // namespace
}  // namespace coopdyn
