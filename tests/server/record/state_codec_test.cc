// SPDX-License-Identifier: MIT
#include "server/record/state_codec.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "record_fixture.h"
#include "server/state/sample_keeper.h"

namespace coopdyn {
namespace {

/// A state that uses every field.
SavedState FullState(FrameMaker& maker) {
  const auto frame = maker.Make(1234);
  frame->epoch = 3;
  frame->revision = 2;
  frame->step_length = 5'000'000;
  frame->seed = ~std::uint64_t{0};
  frame->bodies[0].v_WB.x() = -0.0;
  frame->bodies[1].p_WB.y() = std::numeric_limits<double>::denorm_min();
  frame->bodies[2].sleep_counter = BodyState::kFrozen;
  frame->commanded[2] = 1;
  frame->channels[3].setpoint.mode = ControlMode::kEffort;
  frame->channels[3].effort = 1.0 / 3;
  SentMessage sent;
  sent.robot = 2;
  sent.step = 1230;
  sent.message.count = 3;
  sent.message.values = {1.0 / 3, -0.0, 7};
  frame->messages = {sent, sent};
  frame->messages[1].step = 1234;
  SavedState state;
  state.frame = frame;
  state.controllers = {std::byte{1}, std::byte{2}, std::byte{255}};
  state.scores = {1.0 / 3, -0.0};
  state.mode = Mode::kFree;
  state.paused = true;
  state.step_length = 20'000'000;
  state.setpoints = {{1.0 / 3}, {-0.0}, {2, ControlMode::kPosition}, {3}, {4}, {5}};
  return state;
}

TEST(StateCodecTest, AStateKeepsEveryBit) {
  FrameMaker maker(RecordScene());
  const SavedState state = FullState(maker);
  const SavedStatePtr read = DecodeState(EncodeState(state), maker.scene());
  ASSERT_NE(read, nullptr);
  const Frame &a = *state.frame, &b = *read->frame;
  EXPECT_EQ(b.epoch, a.epoch);
  EXPECT_EQ(b.step, a.step);
  EXPECT_EQ(b.revision, a.revision);
  EXPECT_EQ(b.time, a.time);
  EXPECT_EQ(b.step_length, a.step_length);
  EXPECT_EQ(b.seed, a.seed);
  EXPECT_EQ(b.solver_seed, a.solver_seed);
  EXPECT_EQ(b.scene, a.scene);
  ASSERT_EQ(b.bodies.size(), a.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) EXPECT_TRUE(SameBody(a.bodies[i], b.bodies[i])) << i;
  ASSERT_EQ(b.channels.size(), a.channels.size());
  for (std::size_t i = 0; i < a.channels.size(); ++i) {
    const auto numbers = [](const ChannelState& channel) {
      return std::array{channel.position, channel.velocity, channel.effort, channel.setpoint.reference};
    };
    EXPECT_TRUE(SameBits(numbers(a.channels[i]), numbers(b.channels[i])));
    EXPECT_EQ(b.channels[i].setpoint.mode, a.channels[i].setpoint.mode);
  }
  EXPECT_EQ(b.commanded, a.commanded);
  ASSERT_EQ(b.messages.size(), a.messages.size());
  for (std::size_t i = 0; i < a.messages.size(); ++i) {
    EXPECT_EQ(b.messages[i].robot, a.messages[i].robot);
    EXPECT_EQ(b.messages[i].step, a.messages[i].step);
    EXPECT_EQ(b.messages[i].message.count, a.messages[i].message.count);
    EXPECT_TRUE(SameBits(a.messages[i].message.values, b.messages[i].message.values));
  }
  EXPECT_EQ(read->controllers, state.controllers);
  EXPECT_EQ(read->mode, state.mode);
  EXPECT_TRUE(read->paused);
  EXPECT_EQ(read->step_length, state.step_length);
  EXPECT_EQ(read->setpoints, state.setpoints);
  EXPECT_TRUE(SameBits(read->scores, state.scores));
  EXPECT_EQ(StateHash(b), StateHash(a));
  EXPECT_EQ(EncodeState(*read), EncodeState(state));
}

TEST(StateCodecTest, WhatNoEditHasChangedStaysUnsaid) {
  FrameMaker maker(RecordScene());
  const SavedStatePtr read = DecodeState(EncodeState(*maker.Start()), maker.scene());
  ASSERT_NE(read, nullptr);
  EXPECT_FALSE(read->step_length);
  EXPECT_TRUE(read->setpoints.empty());
}

/// `state`, which has no scores, in the encoding of a version without efforts. For still older versions, the
/// data after bodies and channels begin at `rest`.
std::vector<std::byte> WithoutEfforts(const SavedState& state, std::ptrdiff_t& rest) {
  std::vector<std::byte> bytes = EncodeState(state);
  bytes[0] = std::byte{7};
  constexpr std::ptrdiff_t kHead = 59, kBody = 184, kPlaceAndRate = 16, kEffort = 8, kSetpoint = 9;
  rest = kHead + 4 + kBody * std::ssize(state.frame->bodies) + 4;
  for (std::size_t i = 0; i < state.frame->channels.size(); ++i) {
    rest += kPlaceAndRate;
    bytes.erase(bytes.begin() + rest, bytes.begin() + rest + kEffort);
    rest += kSetpoint;
  }
  return bytes;
}

TEST(StateCodecTest, AStateOfVersion7HasNoEfforts) {
  FrameMaker maker(RecordScene());
  const SavedState state = FullState(maker);
  std::ptrdiff_t rest = 0;
  const SavedStatePtr read = DecodeState(WithoutEfforts(state, rest), maker.scene());
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(StateHash(*read->frame), StateHash(*state.frame));
  EXPECT_TRUE(std::isnan(read->frame->channels[3].effort));
}

TEST(StateCodecTest, AStateOfVersion2HasNoControlBoards) {
  FrameMaker maker(RecordScene());
  SavedState state = FullState(maker);
  state.scores.clear();
  std::ptrdiff_t rest = 0;
  std::vector<std::byte> bytes = WithoutEfforts(state, rest);
  bytes[0] = std::byte{2};
  bytes.resize(bytes.size() - 4);  // the list of scores, empty here
  // The lists of controls, drive trains, measured values, contacts, samples and clocks, all empty here.
  bytes.erase(bytes.begin() + rest, bytes.begin() + rest + 24);
  const SavedStatePtr read = DecodeState(bytes, maker.scene());
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(StateHash(*read->frame), StateHash(*state.frame));
}

TEST(StateCodecTest, DriveTrainsAreKept) {
  FrameMaker maker(RecordScene());
  auto scene = std::make_shared<Scene>(*maker.scene());
  scene->drive_train_count = 1;
  const auto frame = maker.Make(3);
  frame->scene = scene;
  frame->drive_trains = {{1.0 / 3, -0.0, 2, 7}};
  SavedState state;
  state.frame = frame;
  const std::vector<std::byte> bytes = EncodeState(state);
  EXPECT_EQ(bytes[0], std::byte{8});
  const SavedStatePtr read = DecodeState(bytes, scene);
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->frame->drive_trains, frame->drive_trains);
  EXPECT_EQ(StateHash(*read->frame), StateHash(*frame));
  EXPECT_EQ(DecodeState(bytes, maker.scene()), nullptr);
}

class SensedStateTest : public testing::Test {
 protected:
  SensedStateTest() {
    SampleKeeper keeper;
    for (std::uint64_t step = 0; step <= 9; ++step) {
      frame_ = maker_.Make(step);
      frame_->measured = {1.0 / 3, -0.0, static_cast<double>(step)};
      frame_->contacts.resize(1);
      frame_->contacts[0].a.robot = 0;
      frame_->contacts[0].force_W = {1.0 / 3, 0, static_cast<double>(step)};
      keeper.AddTo(*frame_);
    }
    state_.frame = frame_;
  }

  FrameMaker maker_{SensingScene()};
  std::shared_ptr<Frame> frame_;
  SavedState state_;
};

TEST_F(SensedStateTest, WhatSensorsShowIsKept) {
  const SavedStatePtr read = DecodeState(EncodeState(state_), maker_.scene());
  ASSERT_NE(read, nullptr);
  const Frame& frame = *read->frame;
  EXPECT_EQ(frame.measured, frame_->measured);
  EXPECT_EQ(frame.contacts.front().force_W, frame_->contacts.front().force_W);
  ASSERT_EQ(frame.samples.size(), 1);
  ASSERT_EQ(frame.samples[0].size(), frame_->samples[0].size());
  for (std::size_t i = 0; i < frame.samples[0].size(); ++i) {
    const Frame &a = *frame_->samples[0][i], &b = *frame.samples[0][i];
    EXPECT_EQ(b.step, a.step);
    EXPECT_EQ(b.time, a.time);
    EXPECT_EQ(b.measured, a.measured);
    EXPECT_EQ(b.scene, maker_.scene());
    EXPECT_TRUE(SameBody(a.bodies[0], b.bodies[0]));
  }
  EXPECT_EQ(EncodeState(*read), EncodeState(state_));
}

TEST_F(SensedStateTest, ASampleOfTheFutureIsRefused) {
  const auto future = std::make_shared<Frame>();
  *future->bodies.insert(future->bodies.end(), frame_->bodies.begin(), frame_->bodies.end());
  future->channels = frame_->channels;
  future->time = frame_->time + 1;
  frame_->samples[0].push_back(future);
  EXPECT_EQ(DecodeState(EncodeState(state_), maker_.scene()), nullptr);
}

TEST_F(SensedStateTest, AContactOfAnotherSceneIsRefused) {
  frame_->contacts[0].b.object = 12;
  EXPECT_EQ(DecodeState(EncodeState(state_), maker_.scene()), nullptr);
}

TEST_F(SensedStateTest, NoCutMakesAState) {
  const std::vector<std::byte> bytes = EncodeState(state_);
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    EXPECT_EQ(DecodeState(std::span(bytes).first(size), maker_.scene()), nullptr) << size;
  }
}

TEST(StateCodecTest, AStateOfAnotherSceneIsRefused) {
  FrameMaker maker(RecordScene());
  const std::vector<std::byte> bytes = EncodeState(FullState(maker));
  EXPECT_EQ(DecodeState(bytes, RecordScene("[ROBOT_1]\ntype coopbot\nname robot1\nposition 0 0\n")), nullptr);
}

TEST(StateCodecTest, CutOrLengthenedStatesAreRefused) {
  FrameMaker maker(RecordScene());
  const std::vector<std::byte> bytes = EncodeState(FullState(maker));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_EQ(DecodeState(cut, maker.scene()), nullptr) << size;
  }
  std::vector<std::byte> longer = bytes;
  longer.emplace_back();
  EXPECT_EQ(DecodeState(longer, maker.scene()), nullptr);
}

TEST(StateCodecTest, NumbersThatPhysicsCannotHaveAreRefused) {
  FrameMaker maker(RecordScene());
  SavedState state = FullState(maker);
  auto frame = maker.Make(1);
  frame->bodies[3].w_WB.z() = std::numeric_limits<double>::quiet_NaN();
  state.frame = frame;
  EXPECT_EQ(DecodeState(EncodeState(state), maker.scene()), nullptr);
  frame = maker.Make(1);
  frame->step_length = 0;
  state.frame = frame;
  EXPECT_EQ(DecodeState(EncodeState(state), maker.scene()), nullptr);
  frame = maker.Make(1);
  frame->messages.emplace_back().robot = 3;  // there are three
  state.frame = frame;
  EXPECT_EQ(DecodeState(EncodeState(state), maker.scene()), nullptr);
}

TEST(StateCodecTest, MutatedStatesAreRefusedOrWhole) {
  FrameMaker maker(RecordScene());
  const std::vector<std::byte> bytes = EncodeState(FullState(maker));
  std::mt19937 random(9);
  int taken = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::byte> mutated = bytes;
    for (int i = 0; i < 1 + round % 4; ++i) {
      mutated[random() % mutated.size()] = static_cast<std::byte>(random());
    }
    const SavedStatePtr read = DecodeState(mutated, maker.scene());
    if (read == nullptr) continue;
    ++taken;
    EXPECT_EQ(read->frame->bodies.size(), maker.scene()->body_ids.size());
    EXPECT_EQ(read->frame->channels.size(), 6U);
    for (const SentMessage& sent : read->frame->messages) {
      EXPECT_LT(sent.robot, 3U);
      EXPECT_LE(sent.message.count, RobotMessage::kMaxValues);
    }
  }
  EXPECT_GT(taken, 0);  // most flips only change a number
}

// --- scenes
// --------------------------------------------------------------------------------------------------

auto ModelsOf(const Scenario& scenario) {
  return [&scenario](const std::string& type) -> std::shared_ptr<const RobotModel> {
    for (const RobotEntry& entry : scenario.robots) {
      if (entry.model->type == type) return entry.model;
    }
    return nullptr;
  };
}

/// Fields that the test's scenario leaves at their defaults.
std::shared_ptr<Scene> FullScene() {
  auto scene = std::make_shared<Scene>(*RecordScene());
  RobotEntry& entry = scene->robots[1].entry;
  entry.sync = false;
  entry.waits_for = {"motors", "arm"};
  entry.deadline_s = 0.25;
  entry.on_deadline = LossPolicy::kStop;
  entry.on_disconnect = LossPolicy::kDrop;
  entry.watchdog_s = 0;
  entry.color = {0.125, 0.25, 1.0 / 3};
  entry.X_WR.q = FromRollPitchYaw(0.1, 0.2, 0.3);
  entry.controller.name = "diffuse";
  entry.controller.options = {{"speed", 0.2}, {"turn", -0.0}};
  entry.controller.where = {"a.scenario", 12};
  scene->objects[1].object.shape = Cylinder{0.25, 1.0 / 3};
  scene->floor.friction = 0.5;
  // Removed things leave gaps in the ids and indices of bodies.
  for (std::size_t i = 0; i < scene->body_ids.size(); ++i) {
    scene->body_ids[i] = BodyId{static_cast<std::uint32_t>(2 * i + 5)};
  }
  scene->robots[2].id = RobotId{9};
  return scene;
}

TEST(SceneCodecTest, ASceneKeepsEveryBit) {
  const auto scene = FullScene();
  const std::vector<std::byte> bytes = EncodeScene(*scene);
  const auto read = DecodeScene(bytes, scene->scenario, ModelsOf(*scene->scenario));
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(EncodeScene(*read), bytes);
  EXPECT_EQ(read->scenario, scene->scenario);
  ASSERT_EQ(read->robots.size(), 3U);
  const SceneRobot &a = scene->robots[1], &b = read->robots[1];
  EXPECT_EQ(b.entry.name, "robot2");
  EXPECT_EQ(b.entry.model, a.entry.model);
  EXPECT_EQ(b.entry.fidelity, Fidelity::kRolling);
  EXPECT_EQ(b.entry.sync, false);
  EXPECT_EQ(b.entry.waits_for, a.entry.waits_for);
  EXPECT_EQ(b.entry.deadline_s, 0.25);
  EXPECT_EQ(b.entry.on_deadline, LossPolicy::kStop);
  EXPECT_EQ(b.entry.on_disconnect, LossPolicy::kDrop);
  EXPECT_EQ(b.entry.watchdog_s, 0.0);
  EXPECT_EQ(b.entry.color, a.entry.color);
  EXPECT_EQ(b.entry.controller.name, "diffuse");
  EXPECT_EQ(b.entry.controller.options, a.entry.controller.options);
  EXPECT_EQ(b.entry.controller.where.line, 12);
  EXPECT_TRUE(SameBits(b.entry.X_WR.p, a.entry.X_WR.p));
  EXPECT_TRUE(SameBits(b.entry.X_WR.q.coeffs(), a.entry.X_WR.q.coeffs()));
  EXPECT_TRUE(SameBits(b.X_BR.p, a.X_BR.p));
  EXPECT_EQ(b.axes_of_R, a.axes_of_R);
  EXPECT_EQ(read->robots[0].entry.on_disconnect, std::nullopt);
  EXPECT_EQ(read->robots[0].entry.watchdog_s, std::nullopt);
  EXPECT_EQ(read->robots[0].entry.deadline_s, std::nullopt);
  EXPECT_FALSE(read->robots[2].entry.sockets);
  EXPECT_EQ(read->robots[2].id, RobotId{9});
  EXPECT_EQ(read->body_ids, scene->body_ids);
  ASSERT_EQ(read->objects.size(), 2U);
  EXPECT_EQ(read->objects[0].object.name, scene->objects[0].object.name);
  EXPECT_EQ(std::get<Cylinder>(read->objects[1].object.shape).length_m, 1.0 / 3);
  ASSERT_EQ(read->targets.size(), 2U);
  EXPECT_EQ(read->targets[1].color_name, "blue");
  EXPECT_TRUE(SameBits(read->targets[1].p_WT, scene->targets[1].p_WT));
}

TEST(SceneCodecTest, ASceneKeepsHowThingsMoveAndTouch) {
  const auto scene = FullScene();
  WorldObject& object = scene->objects[0].object;
  object.restitution = 0.75;
  object.rolling_friction_m = 1.0 / 3;
  object.v_WO = {1, -2, 1.0 / 3};
  object.w_WO = {0, -0.0, 7};
  const std::vector<std::byte> bytes = EncodeScene(*scene);
  EXPECT_EQ(bytes.front(), std::byte{5});
  const auto read = DecodeScene(bytes, scene->scenario, ModelsOf(*scene->scenario));
  ASSERT_NE(read, nullptr);
  const WorldObject& again = read->objects[0].object;
  EXPECT_EQ(again.restitution, 0.75);
  EXPECT_EQ(again.rolling_friction_m, 1.0 / 3);
  EXPECT_TRUE(SameBits(again.v_WO, object.v_WO));
  EXPECT_TRUE(SameBits(again.w_WO, object.w_WO));
  EXPECT_EQ(read->robots[1].entry.watchdog_s, 0.0);
  EXPECT_EQ(EncodeScene(*read), bytes);
  object.restitution = 1.5;
  EXPECT_EQ(DecodeScene(EncodeScene(*scene), scene->scenario, ModelsOf(*scene->scenario)), nullptr);
}

TEST(SceneCodecTest, ASceneWithoutWatchdogsIsWrittenAsItAlwaysWas) {
  const auto scene = FullScene();
  EXPECT_EQ(EncodeScene(*scene).front(), std::byte{4});
  scene->robots[1].entry.watchdog_s.reset();
  const std::vector<std::byte> bytes = EncodeScene(*scene);
  EXPECT_EQ(bytes.front(), std::byte{3});
  EXPECT_NE(DecodeScene(bytes, scene->scenario, ModelsOf(*scene->scenario)), nullptr);
}

TEST(SceneCodecTest, TexturesAreThoseOfTheScenarioAndNewThingsHaveNone) {
  auto scenario = std::make_shared<Scenario>(*ReadRecordScenario());
  scenario->floor.texture.image = std::make_shared<Image>();
  scenario->objects[0].texture = {std::make_shared<Image>(), 1, 1};
  scenario->objects[1].texture = {std::make_shared<Image>(), 0.5, 0.25};
  Scene scene = *MakeScene(scenario);
  scene.objects[0].object.name = "NEW_1";
  scene.objects[0].object.texture = {};
  const auto read = DecodeScene(EncodeScene(scene), scenario, ModelsOf(*scenario));
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->floor.texture.image, scenario->floor.texture.image);
  EXPECT_EQ(read->objects[0].object.texture.image, nullptr);
  EXPECT_EQ(read->objects[1].object.texture.image, scenario->objects[1].texture.image);
  EXPECT_EQ(read->objects[1].object.texture.width_m, 0.5);
}

TEST(SceneCodecTest, TheCodeOfAControllerIsFoundByTheScenarioNotByTheRecording) {
  auto scenario = std::make_shared<Scenario>(*ReadRecordScenario());
  scenario->robots[1].controller.name = "diffuse";
  scenario->robots[1].controller.file = "/where/the/run/was/diffuse.so";
  const auto recorded = MakeScene(scenario);
  const std::vector<std::byte> bytes = EncodeScene(*recorded);
  auto here = std::make_shared<Scenario>(*scenario);
  here->robots[1].controller.file = "/where/it/is/here/diffuse.so";
  const auto read = DecodeScene(bytes, here, ModelsOf(*here));
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->robots[1].entry.controller.file, "/where/it/is/here/diffuse.so");
  here->robots[1].controller = {};
  const auto without = DecodeScene(bytes, here, ModelsOf(*here));
  ASSERT_NE(without, nullptr);
  EXPECT_EQ(without->robots[1].entry.controller.file, "");
}

TEST(SceneCodecTest, AMissingModelIsRefused) {
  const auto scene = FullScene();
  EXPECT_EQ(DecodeScene(EncodeScene(*scene), scene->scenario, [](const std::string&) { return nullptr; }),
            nullptr);
}

TEST(SceneCodecTest, PlacesThatDoNotFitAreRefused) {
  const auto refused = [](const std::function<void(Scene&)>& spoil) {
    const auto scene = FullScene();
    spoil(*scene);
    return DecodeScene(EncodeScene(*scene), scene->scenario, ModelsOf(*scene->scenario)) == nullptr;
  };
  EXPECT_FALSE(refused([](Scene&) {}));
  EXPECT_TRUE(refused([](Scene& scene) { scene.robots[1].first_body = 0; }));  // of BOX_1
  EXPECT_TRUE(refused([](Scene& scene) { scene.robots[1].first_body = 1 << 30; }));
  EXPECT_TRUE(refused([](Scene& scene) { scene.robots[1].first_body = -1; }));
  EXPECT_TRUE(refused([](Scene& scene) { scene.robots[0].body_count = 1; }));
  EXPECT_TRUE(refused([](Scene& scene) { scene.robots[2].id = RobotId{1}; }));
  EXPECT_TRUE(refused([](Scene& scene) { scene.objects[1].body = 0; }));
  EXPECT_TRUE(refused([](Scene& scene) { scene.objects[0].body = -1; }));
  EXPECT_TRUE(refused([](Scene& scene) { scene.body_ids.pop_back(); }));
  EXPECT_TRUE(refused([](Scene& scene) { scene.body_ids.push_back(BodyId{1000}); }));
  EXPECT_TRUE(refused([](Scene& scene) { scene.objects[1].object.shape = Sphere{-1}; }));
  EXPECT_TRUE(refused([](Scene& scene) { scene.objects[1].object.X_WO.q.coeffs() *= 2; }));
}

TEST(SceneCodecTest, CutAndMutatedScenesAreRefusedOrFit) {
  const auto scene = FullScene();
  const std::vector<std::byte> bytes = EncodeScene(*scene);
  const auto models = ModelsOf(*scene->scenario);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_EQ(DecodeScene(cut, scene->scenario, models), nullptr) << size;
  }
  std::mt19937 random(11);
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::byte> mutated = bytes;
    for (int i = 0; i < 1 + round % 4; ++i) {
      mutated[random() % mutated.size()] = static_cast<std::byte>(random());
    }
    const auto read = DecodeScene(mutated, scene->scenario, models);
    if (read == nullptr) continue;
    for (const SceneRobot& robot : read->robots) {
      const auto end = static_cast<std::size_t>(robot.first_body + robot.body_count);
      EXPECT_LE(end, read->body_ids.size());
    }
  }
}

}  // namespace
}  // namespace coopdyn
