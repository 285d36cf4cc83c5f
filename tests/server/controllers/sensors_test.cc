// SPDX-License-Identifier: MIT
// Readings of the sensors that loaded controllers request.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "server/state/sample_keeper.h"
#include "tests/server/controllers/swarm.h"
#include "tests/server/model/read_text.h"

namespace coopdyn {
namespace {

using testing::ElementsAre;

/// A robot with an IMU at 50 Hz, two cameras and a battery, driven by a controller that requests some of
/// them.
class FeelingRobot {
 public:
  explicit FeelingRobot(bool in_process, DrawPictures draw = nullptr)
      : pool_(1), host_(TestOptions(in_process), clock_, NullLogger(), pool_, std::move(draw)) {
    Scenario scenario = *Good("[FLOOR]\n[ROBOT_1]\ntype coopbot\nname r1\nposition 0 0\n");
    auto model = std::make_shared<RobotModel>(*scenario.robots[0].model);
    model->AddSensor("imu", ImuModel(), {50, 0});
    CameraModel camera;
    camera.width = 4;
    camera.height = 3;
    model->AddSensor("left_eye", camera);
    model->AddSensor("right_eye", camera);
    model->AddSensor("battery", BatteryModel());
    scenario.robots[0].model = model;
    scenario.robots[0].controller.name = "feeler";
    scenario.robots[0].controller.file = std::string(TEST_CONTROLLERS) + "/feeler.so";
    scene_ = MakeScene(std::make_shared<Scenario>(scenario));
    host_.Configure(MakeFrame());
  }

  /// The robot's broadcast in the next step.
  std::vector<double> Step() {
    std::vector<Setpoint> channels(scene_->channels.size());
    std::vector<SentMessage> messages;
    host_.Step(frame_, channels, messages);
    ++step_;
    MakeFrame();
    if (messages.empty()) return {};
    const RobotMessage& message = messages.front().message;
    return {message.values.begin(), message.values.begin() + message.count};
  }

 private:
  FramePtr MakeFrame() {
    const auto frame = std::make_shared<Frame>();
    frame->step = step_;
    frame->time = static_cast<Nanoseconds>(step_) * kDefaultStep;
    frame->scene = scene_;
    frame->bodies.resize(scene_->body_ids.size());
    frame->channels.resize(scene_->channels.size());
    frame->measured = {0, 0, static_cast<double>(step_), 1, 1};  // the IMU's, then the battery's
    frame->commanded.resize(1);
    keeper_.AddTo(*frame);
    return frame_ = frame;
  }

  SteadyClock clock_;
  WorkerPool pool_;
  ControllerHost host_;
  std::shared_ptr<const Scene> scene_;
  SampleKeeper keeper_;
  std::uint64_t step_ = 0;
  FramePtr frame_;
};

class ControllerSensorsTest : public testing::TestWithParam<bool> {};

TEST_P(ControllerSensorsTest, ItGetsTheSamplesOfTheModulesThatItNames) {
  FeelingRobot robot(GetParam());
  EXPECT_THAT(robot.Step(), ElementsAre(2, 9.81, 0, 0, 0));
  EXPECT_THAT(robot.Step(), ElementsAre(2, 9.81, 0, 0, 0));  // the sample of step 0 at 50 Hz
  EXPECT_THAT(robot.Step(), ElementsAre(2, 11.81, 2, 0, 0));
}

TEST_P(ControllerSensorsTest, PicturesAreDrawnOfTheCamerasThatItNames) {
  std::vector<CameraShot> drawn;
  FeelingRobot robot(GetParam(), [&drawn](std::span<const PictureWanted> wanted) {
    for (const PictureWanted& one : wanted) {
      drawn.push_back(one.shot);
      EXPECT_EQ(one.rgb.size(), 36);
      for (std::size_t i = 0; i < one.rgb.size(); ++i) one.rgb[i] = static_cast<std::uint8_t>(10 + i);
    }
    return std::string();
  });
  EXPECT_THAT(robot.Step(), ElementsAre(2, 9.81, 0, 10, 45));
  ASSERT_EQ(drawn.size(), 1);
  EXPECT_EQ(drawn[0].frame->step, 0);
  EXPECT_EQ(drawn[0].frame->scene->robots[0].entry.model->sensors[drawn[0].sensor].name, "left_eye");
}

INSTANTIATE_TEST_SUITE_P(Hosts, ControllerSensorsTest, testing::Bool(),
                         [](const auto& info) { return info.param ? "InProcess" : "InAChild"; });

/// Answers requests as the render thread does, on a separate thread.
TEST(DrawOnTest, MorePicturesThanTheBoardTakesAtOnceAreAllDrawn) {
  ImageBoard board;
  const SteadyClock clock;
  std::jthread drawer([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      for (ImageBoard::Pending& pending : board.WaitAndTake(stop, clock, 0)) {
        ImageResult result;
        result.bytes = std::make_shared<const std::vector<std::uint8_t>>(
            3, static_cast<std::uint8_t>(pending.request.shot->sensor));
        pending.done(result);
      }
    }
  });
  std::vector<std::array<std::uint8_t, 3>> pictures(200);
  std::vector<PictureWanted> wanted;
  for (std::size_t i = 0; i < pictures.size(); ++i) wanted.push_back({{nullptr, 0, i}, pictures[i]});
  EXPECT_EQ(DrawOn(board)(wanted), "");
  for (std::size_t i = 0; i < pictures.size(); ++i) EXPECT_EQ(pictures[i][2], i);
}

TEST(DrawOnTest, WhatCannotBeDrawnIsBlackAndTold) {
  ImageBoard board;
  board.Close("no pictures here");
  std::vector<std::uint8_t> picture(3, 7);
  const std::vector<PictureWanted> wanted = {{{nullptr, 0, 0}, picture}};
  EXPECT_EQ(DrawOn(board)(wanted), "no pictures here");
  EXPECT_EQ(picture, std::vector<std::uint8_t>(3, 0));
}

}  // namespace
}  // namespace coopdyn
