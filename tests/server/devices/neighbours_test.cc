// SPDX-License-Identifier: MIT
// /R/neighbours as a device: the content of its replies. Tests of sensing cover visibility and range.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "protocol/module_tables.h"
#include "server/devices/device.h"
#include "server/sensing/readings.h"
#include "tests/server/devices/small_world.h"
#include "tests/server/model/sensor_of.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Four robots 10 m apart in a row along y, which see 15 m and hear 25 m far.
class NeighboursDeviceTest : public testing::Test {
 protected:
  NeighboursDeviceTest() {
    auto model = std::make_shared<RobotModel>(*SmallModel());
    SensorOf<NeighboursModel>(*model) = {.range_m = 15, .message_range_m = 25, .loss = 0, .delay_steps = 2};
    auto scenario = std::make_shared<Scenario>(*SmallScenario(4));
    for (RobotEntry& entry : scenario->robots) entry.model = model;
    world_.Load(scenario, Mode::kLockstep);
    device_ = MakeDevice(*model, "neighbours");
    frame_ = world_.MakeFrame({});
  }

  Message Read(command::Id id, int robot) {
    Message request;
    request.command = id;
    return device_->Read(request, *frame_, robot);
  }
  void Send(std::uint32_t robot, std::uint64_t step, std::initializer_list<double> values) {
    SentMessage sent{robot, step, {}};
    for (const double value : values) sent.message.values[sent.message.count++] = value;
    frame_->messages.push_back(sent);
  }

  SmallWorld world_;
  std::unique_ptr<Device> device_;
  std::shared_ptr<Frame> frame_;
};

TEST_F(NeighboursDeviceTest, TellsIdsNamesDistancesAndBearingsOfThoseWithinRange) {
  const Message reply = Read(command::kGetNeighbours, 1);
  EXPECT_THAT(reply.params, ElementsAre(1, 3));
  EXPECT_EQ(reply.text, "robot1 robot3");
  ASSERT_EQ(reply.data.size(), 4u);
  EXPECT_NEAR(reply.data[0], 10, 1e-12);
  EXPECT_NEAR(reply.data[1], -std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(reply.data[3], std::numbers::pi / 2, 1e-12);
}

TEST_F(NeighboursDeviceTest, ItsFirstReadingIsTheDataOfGetNeighbours) {
  EXPECT_EQ(device_->first_reading(), command::kGetNeighbours);
  std::vector<double> data;
  device_->AppendFirstReading(*frame_, 0, data);
  EXPECT_EQ(data, Read(command::kGetNeighbours, 0).data);
  EXPECT_FALSE(device_->is_actuator());
}

TEST_F(NeighboursDeviceTest, MessagesCarrySenderCountPlaceAndNumbers) {
  frame_->step = 12;
  Send(0, 10, {7});
  Send(2, 10, {1, 2, 3});
  Send(3, 10, {9});  // 20 m away
  Send(0, 11, {5});  // arrives later
  const Message reply = Read(command::kGetMessages, 1);
  EXPECT_THAT(reply.params, ElementsAre(1, 1, 3, 3, 4, 1));
  ASSERT_EQ(reply.data.size(), 3u + 5 + 3);
  EXPECT_NEAR(reply.data[0], 10, 1e-12);
  EXPECT_NEAR(reply.data[1], -std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(reply.data[2], 7);
  EXPECT_EQ(reply.data[7], 3);
  EXPECT_NEAR(reply.data[8], 20, 1e-12);
  EXPECT_EQ(reply.data[10], 9);
  EXPECT_THAT(Read(command::kGetMessages, 3).params, ElementsAre(2 + 1, 3));
}

TEST_F(NeighboursDeviceTest, TellsTheLinkWithTheDelayInSeconds) {
  frame_->step_length = 5 * kNanosecondsPerSecond / 100;
  EXPECT_THAT(Read(command::kGetLink, 0).data, ElementsAre(15, 25, 0, 0.1));
}

TEST_F(NeighboursDeviceTest, OnlySendMessageBroadcasts) {
  Message request;
  request.command = command::kSendMessage;
  request.data = {1, 2.5};
  const std::optional<RobotMessage> message = device_->Broadcast(request);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->count, 2u);
  EXPECT_EQ(message->values[1], 2.5);
  request.command = command::kGetLink;
  EXPECT_FALSE(device_->Broadcast(request));
  const CommandTable table = NeighboursTable();
  for (const std::size_t count : {std::size_t{0}, RobotMessage::kMaxValues + 1}) {
    EXPECT_EQ(CheckRequest(*table.Find(command::kSendMessage), "", {}, std::vector<double>(count, 1)).error,
              3);
  }
  EXPECT_EQ(CheckRequest(*table.Find(command::kSendMessage), "", {},
                         std::vector<double>(RobotMessage::kMaxValues, 1))
                .error,
            0);
}

}  // namespace
}  // namespace coopdyn
