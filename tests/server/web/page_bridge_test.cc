// SPDX-License-Identifier: MIT
#include "server/web/page_bridge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "protocol/command_ids.h"
#include "web_fixture.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;

/// A bridge for a client on another machine, on a separate thread.
class StrangerTest : public testing::Test {
 protected:
  StrangerTest() {
    thread_.Call([this] {
      bridge_ = std::make_unique<PageBridge>(thread_.context(), world_.names, world_.frames,
                                             PeerInfo{.text = "page 10.0.0.7:5000", .trusted = false},
                                             [this](const PageReply& reply) { replied_.set_value(reply); });
    });
  }
  ~StrangerTest() override {
    thread_.Call([this] { bridge_ = nullptr; });
  }

  Message Call(const std::string& module, const std::string& command, std::vector<double> data = {}) {
    PageCall call;
    call.module = module;
    call.command_name = command;
    call.message.data = std::move(data);
    return Send(call);
  }
  Message Send(const PageCall& call) {
    replied_ = {};
    std::future<PageReply> reply = replied_.get_future();
    thread_.Call([&] { bridge_->Handle(call); });
    return reply.get().message;
  }
  void SetTrusted() {
    thread_.Call([this] { bridge_->SetTrusted(true); });
  }

  WebWorld world_;
  IoThread thread_{"bridge", NullLogger()};
  std::promise<PageReply> replied_;
  std::unique_ptr<PageBridge> bridge_;
};

TEST_F(StrangerTest, MayRead) {
  EXPECT_EQ(Call("/robot1/motors", "get_wheels").error, 0);
  EXPECT_EQ(Call("/simulation", "get_status").error, 0);
}

TEST_F(StrangerTest, HasFewConnectionsToModules) {
  PageCall call;
  call.module = "/robot1/motors";
  call.command_name = "get_wheels";
  for (std::size_t i = 0; i < PageBridge::kMaxStrangersLinks; ++i) {
    call.channel = std::to_string(i);
    EXPECT_EQ(Send(call).error, 0);
  }
  call.channel = "one more";
  EXPECT_EQ(Send(call).text, "this page has too many connections open");
  SetTrusted();
  EXPECT_EQ(Send(call).error, 0);
}

TEST_F(StrangerTest, MayChangeNothingOfTheSimulation) {
  for (const char* command : {"quit", "pause", "reset"}) {
    const Message reply = Call("/simulation", command);
    EXPECT_EQ(reply.error, static_cast<std::int32_t>(Error::kNotAllowed)) << command;
    EXPECT_THAT(reply.text, HasSubstr("token"));
  }
}

TEST_F(StrangerTest, DrivesARobotAsAProgramMay) {
  EXPECT_EQ(Call("/robot1/motors", "set_velocity", {0.1, 0}).error, 0);
  EXPECT_EQ(world_.motors.open_owners, 1);
}

TEST_F(StrangerTest, ARobotsModuleSeesThatItIsOne) {
  Call("/robot1/motors", "get_wheels");
  EXPECT_FALSE(world_.motors.trusted);
  SetTrusted();
  Call("/robot1/motors", "get_wheels");
  EXPECT_TRUE(world_.motors.trusted);
}

TEST_F(StrangerTest, AConnectionNamesThePersonAndThenTheAddress) {
  thread_.Call([this] { bridge_->SetPerson("Ana Lima"); });
  Call("/robot1/motors", "get_wheels");
  EXPECT_EQ(world_.motors.peer, "Ana Lima, page 10.0.0.7:5000");
}

TEST_F(StrangerTest, CannotHideACommandInALineOrANumber) {
  PageCall line;
  line.module = "/simulation";
  line.line = "0 \"\" " + std::to_string(command::kPause) + " 0 0";
  EXPECT_EQ(Send(line).error, static_cast<std::int32_t>(Error::kNotAllowed));
  PageCall unknown;
  unknown.module = "/simulation";
  unknown.message.command = 12345;
  EXPECT_EQ(Send(unknown).error, static_cast<std::int32_t>(Error::kNotAllowed));
}

TEST_F(StrangerTest, MayChangeThingsWithTheToken) {
  EXPECT_EQ(Call("/simulation", "run").error, static_cast<std::int32_t>(Error::kNotAllowed));
  SetTrusted();
  EXPECT_EQ(Call("/simulation", "run").error, 0);
  EXPECT_EQ(Call("/robot1/motors", "set_velocity", {0.1, 0}).error, 0);
}

TEST_F(StrangerTest, ModulesSeeAStrangerToo) {
  Call("/simulation", "get_status");  // opens an untrusted connection
  SetTrusted();                       // closes it: the next one is trusted
  EXPECT_EQ(Call("/simulation", "run").error, 0);
}

}  // namespace
}  // namespace coopdyn
