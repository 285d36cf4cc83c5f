// SPDX-License-Identifier: MIT
#include "server/record/recorded_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "record_fixture.h"
#include "server/sensing/readings.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

TEST(RecordWhatTest, WordsAreReadInAnyOrder) {
  std::string unknown;
  EXPECT_EQ(ParseRecordWhat("targets, poses,channels", unknown), (RecordWhat{true, false, true, false}));
  EXPECT_EQ(ParseRecordWhat("poses", unknown), RecordWhat());
  EXPECT_EQ(ParseRecordWhat("all", unknown), (RecordWhat{true, true, true, true}));
}

TEST(RecordWhatTest, WhatIsWrittenIsReadAgain) {
  for (int bits = 0; bits < 16; ++bits) {
    const RecordWhat what{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0};
    std::string unknown;
    EXPECT_EQ(ParseRecordWhat(ToString(what), unknown), what);
  }
  EXPECT_EQ(ToString(RecordWhat{true, true, true, true}), "poses,channels,distances,targets,controllers");
}

TEST(RecordWhatTest, AnUnknownWordIsNamed) {
  std::string unknown;
  EXPECT_FALSE(ParseRecordWhat("poses,weels", unknown));
  EXPECT_EQ(unknown, "weels");
  EXPECT_FALSE(ParseRecordWhat("wheels", unknown));
  EXPECT_FALSE(ParseRecordWhat("", unknown));
  EXPECT_FALSE(ParseRecordWhat("poses,", unknown));
}

TEST(RecordWhatTest, EverythingUpToFiftyRobotsThenPosesAndControllers) {
  EXPECT_EQ(DefaultRecordWhat(50), (RecordWhat{true, true, true, true}));
  EXPECT_EQ(DefaultRecordWhat(51), (RecordWhat{false, false, false, true}));
}

TEST(RecordedStepTest, CommandsKeepEveryBit) {
  const std::vector<CommandRecord> commands{{0, true, {1.0 / 3, ControlMode::kEffort}},
                                            {1, true, {-0.0}},
                                            {4711, false, {std::numeric_limits<double>::denorm_min()}}};
  std::vector<std::byte> blob;
  EncodeCommands(commands, blob);
  EXPECT_EQ(blob.size(), 39U);
  std::vector<CommandRecord> read;
  ASSERT_TRUE(DecodeCommands(blob, read));
  ASSERT_EQ(read.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read[i].channel, commands[i].channel);
    EXPECT_EQ(read[i].by_client, commands[i].by_client);
    EXPECT_TRUE(SameBits(read[i].setpoint, commands[i].setpoint));
  }
}

TEST(RecordedStepTest, CommandsOutOfOrderAreRefused) {
  for (const std::uint32_t second : {0u, 1u}) {
    std::vector<std::byte> blob;
    EncodeCommands(std::vector<CommandRecord>{{1, true, {1}}, {second, true, {2}}}, blob);
    std::vector<CommandRecord> read;
    EXPECT_FALSE(DecodeCommands(blob, read)) << second;
  }
}

TEST(RecordedStepTest, CommandsThatDoNotAddUpAreRefused) {
  std::vector<std::byte> blob;
  EncodeCommands(std::vector<CommandRecord>{{1, true, {1}}}, blob);
  std::vector<CommandRecord> read;
  EXPECT_FALSE(DecodeCommands(std::span(blob).first(12), read));
  EXPECT_TRUE(read.empty());
  blob[4] = std::byte{6};  // no mode
  EXPECT_FALSE(DecodeCommands(blob, read));
  blob[4] = std::byte{3};
  EXPECT_TRUE(DecodeCommands(blob, read));
  blob[12] = std::byte{0x7F};
  blob[11] = std::byte{0xF8};  // not a number
  EXPECT_FALSE(DecodeCommands(blob, read));
  EXPECT_TRUE(read.empty());
}

TEST(RecordedStepTest, MessagesKeepEveryBitAndTheirStep) {
  SentMessage one, other;
  one.robot = 3;
  one.message.count = 2;
  one.message.values = {1.0 / 3, -0.0};
  other.robot = 5;
  other.message.count = 8;
  other.message.values = {1, 2, 3, 4, 5, 6, 7, 8};
  std::vector<std::byte> blob;
  EncodeMessages(std::vector<SentMessage>{one, other}, blob);
  std::vector<SentMessage> read;
  ASSERT_TRUE(DecodeMessages(blob, 77, read));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].robot, 3U);
  EXPECT_EQ(read[0].step, 77U);
  EXPECT_EQ(read[0].message.count, 2U);
  EXPECT_TRUE(SameBits(read[0].message.values, one.message.values));
  EXPECT_EQ(read[1].robot, 5U);
  EXPECT_TRUE(SameBits(read[1].message.values, other.message.values));
}

TEST(RecordedStepTest, MessagesThatDoNotAddUpAreRefused) {
  std::vector<std::byte> blob;
  SentMessage sent;
  sent.message.count = 8;
  EncodeMessages(std::vector<SentMessage>{sent, sent}, blob);
  std::vector<SentMessage> read;
  EXPECT_FALSE(DecodeMessages(std::span(blob).first(blob.size() - 1), 1, read));
  EXPECT_TRUE(read.empty());
  blob[4] = std::byte{9};  // more values than a message has
  EXPECT_FALSE(DecodeMessages(blob, 1, read));
  EXPECT_TRUE(read.empty());
}

TEST(RecordedStepTest, PositionsAreWithinTheirUnits) {
  FrameMaker maker(RecordScene());
  const auto frame = maker.Make(1);
  SetTurned(*frame, 0, {5.4e6, -5.4e6}, {1, 2});  // 30 h at 50 rad/s
  std::vector<std::byte> blob;
  EncodeChannels(frame->channels, blob);
  std::vector<ChannelMotion> read(frame->channels.size());
  SensedStep none;
  EXPECT_EQ(blob.size(), 9 * read.size());
  ASSERT_TRUE(DecodeChannels(blob, *frame->scene, read, none));
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i].position, frame->channels[i].position, 0.5e-5 + 1e-9);
    EXPECT_EQ(read[i].velocity, static_cast<float>(frame->channels[i].velocity));
  }
  EXPECT_FALSE(DecodeChannels(std::span(blob).first(blob.size() - 1), *frame->scene, read, none));
}

TEST(RecordedStepTest, PositionsBeyondTheUnitsAreHeld) {
  FrameMaker maker(RecordScene());
  const auto frame = maker.Make(1);
  SetTurned(*frame, 0, {1e12, -std::numeric_limits<double>::infinity()}, {1, 2});
  std::vector<std::byte> blob;
  EncodeChannels(frame->channels, blob);
  std::vector<ChannelMotion> read(frame->channels.size());
  SensedStep none;
  ASSERT_TRUE(DecodeChannels(blob, *frame->scene, read, none));
  EXPECT_NEAR(read[0].position, 5497558.13887, 1e-6);
  EXPECT_NEAR(read[1].position, -5497558.13887, 1e-6);
}

class SensedStepTest : public testing::Test {
 protected:
  SensedStepTest() {
    frame_->measured = {1.5, -2, 1e-3};
    Contact contact;
    contact.a = {-1, 0, 0, 0};
    contact.b = {1, -1, 0, 0};
    contact.p_W = {1, 2, 3};
    contact.force_W = {0, 0, 4.5};
    frame_->contacts = {contact, contact};
    frame_->contacts[1].b = {};  // the floor
    EncodeChannels(frame_->channels, blob_);
    EncodeSensed(*frame_, blob_);
  }
  bool Decode() { return DecodeChannels(blob_, *frame_->scene, channels_, read_); }

  FrameMaker maker_{SensingScene()};
  std::shared_ptr<Frame> frame_ = maker_.Make(1);
  std::vector<std::byte> blob_;
  std::vector<ChannelMotion> channels_ = std::vector<ChannelMotion>(frame_->channels.size());
  SensedStep read_;
};

TEST_F(SensedStepTest, MeasuredValuesAndContactsAreReadAgain) {
  ASSERT_TRUE(Decode());
  ASSERT_EQ(read_.measured.size(), 3);
  EXPECT_EQ(read_.measured[0], 1.5);
  EXPECT_EQ(read_.measured[2], static_cast<double>(1e-3F));
  ASSERT_EQ(read_.contacts.size(), 2);
  EXPECT_EQ(read_.contacts[0].a, frame_->contacts[0].a);
  EXPECT_EQ(read_.contacts[0].b, frame_->contacts[0].b);
  EXPECT_EQ(read_.contacts[0].p_W, Vector3(1, 2, 3));
  EXPECT_EQ(read_.contacts[1].force_W, Vector3(0, 0, 4.5));
}

TEST_F(SensedStepTest, WhatWasRecordedWithoutThemIsReadWithoutThem) {
  blob_.resize(kChannelBytes * channels_.size());
  ASSERT_TRUE(Decode());
  EXPECT_TRUE(read_.measured.empty());
}

TEST_F(SensedStepTest, AnyOtherLengthIsRefused) {
  const std::size_t channels = kChannelBytes * channels_.size(), whole = blob_.size();
  const std::vector<std::byte> all = blob_;
  for (std::size_t size = 0; size < whole; ++size) {
    blob_.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(Decode(), size == channels) << size;
  }
  blob_ = all;
  blob_.push_back(std::byte{0});
  EXPECT_FALSE(Decode());
}

TEST_F(SensedStepTest, AContactOfWhatIsNotThereIsRefused) {
  blob_.resize(kChannelBytes * channels_.size());
  frame_->contacts[0].a.robot = 17;
  EncodeSensed(*frame_, blob_);
  EXPECT_FALSE(Decode());
}

/// Decodes the encoding of a frame by `encode`.
std::vector<float> FloatsOf(const Frame& frame, void (*encode)(const Frame&, std::vector<std::byte>&)) {
  std::vector<std::byte> blob;
  encode(frame, blob);
  std::vector<float> floats;
  EXPECT_TRUE(DecodeFloats(blob, floats));
  return floats;
}

TEST(RecordedStepTest, ReadingsAreThoseOfTheSensors) {
  FrameMaker maker(RecordScene());
  const auto frame = maker.Make(1);
  const std::vector<float> distances = FloatsOf(*frame, EncodeDistances);
  std::size_t at = 0;
  for (int robot = 0; robot < 3; ++robot) {
    for (const double range_m : Distances(*frame, robot)) {
      ASSERT_LT(at, distances.size());
      EXPECT_EQ(distances[at++], static_cast<float>(range_m));
    }
  }
  EXPECT_EQ(at, distances.size());
  EXPECT_GT(at, 0U);
}

TEST(RecordedStepTest, TargetsThatAreNotSeenAreNoNumbers) {
  FrameMaker maker(RecordScene());
  const auto frame = maker.Make(1);
  const std::vector<float> values = FloatsOf(*frame, EncodeTargets);
  ASSERT_EQ(values.size(), 3U * 2U * 2U);
  std::size_t seen = 0;
  for (int robot = 0; robot < 3; ++robot) {
    for (const Sighting& sighting : SeenTargets(*frame, robot)) {
      const std::size_t at = static_cast<std::size_t>(robot * 4 + sighting.index * 2);
      EXPECT_EQ(values[at], static_cast<float>(sighting.distance_m));
      EXPECT_EQ(values[at + 1], static_cast<float>(sighting.bearing_rad));
      ++seen;
    }
  }
  std::size_t numbers = 0;
  for (const float value : values) numbers += std::isnan(value) ? 0 : 1;
  EXPECT_EQ(numbers, 2 * seen);
}

TEST(RecordedStepTest, FloatsComeInFours) {
  std::vector<float> values;
  const std::vector<std::byte> blob(7);
  EXPECT_FALSE(DecodeFloats(blob, values));
  EXPECT_TRUE(values.empty());
}

TEST(RecordedStepTest, MutatedBytesNeverReadTooFar) {
  std::vector<std::byte> commands, messages;
  EncodeCommands(
      std::vector<CommandRecord>{{0, true, {}}, {1, true, {}}, {2, true, {}}, {3, true, {}}, {4, true, {}}},
      commands);
  SentMessage sent;
  sent.message.count = 4;
  EncodeMessages(std::vector<SentMessage>(5, sent), messages);
  std::mt19937 random(3);
  for (int round = 0; round < 2000; ++round) {
    // Copies of their exact size, so that AddressSanitizer sees one byte too many.
    std::vector<std::byte> blob = round % 2 == 0 ? commands : messages;
    blob[random() % blob.size()] = static_cast<std::byte>(random());
    blob.resize(random() % (blob.size() + 1));
    blob.shrink_to_fit();
    std::vector<CommandRecord> read_commands;
    std::vector<SentMessage> read_messages;
    EXPECT_TRUE(DecodeCommands(blob, read_commands) || read_commands.empty());
    EXPECT_TRUE(DecodeMessages(blob, 1, read_messages) || read_messages.empty());
  }
}

}  // namespace
}  // namespace coopdyn
