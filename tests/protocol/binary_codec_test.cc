// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <random>

#include "protocol/command_ids.h"
#include "vectors.h"

namespace coopdyn {
namespace {

std::string Frame(const Message& message) {
  std::string bytes;
  EncodeBinary(message, bytes);
  return bytes;
}

Message LoadScenario(std::size_t text_bytes) {
  return {.error = 0,
          .text = std::string(text_bytes, 'x'),
          .command = command::kLoadScenario,
          .params = {},
          .data = {}};
}

TEST(BinaryCodec, EveryTruncationOfAValidFrameNeedsMore) {
  for (const MessageVector& vector : MessageVectors()) {
    for (std::size_t n = 0; n < vector.binary.size(); ++n) {
      const Decoded decoded = DecodeBinary(std::string_view(vector.binary).substr(0, n));
      EXPECT_EQ(decoded.status, DecodeStatus::kNeedMore) << vector.name << " at " << n;
      EXPECT_EQ(decoded.consumed, 0u);
    }
  }
}

TEST(BinaryCodec, BytesFedOneByOneGiveTheSameMessages) {
  std::string stream;
  for (const MessageVector& vector : MessageVectors()) stream += vector.binary;
  std::vector<Message> messages;
  std::string buffer;
  for (const char byte : stream) {
    buffer += byte;
    Decoded decoded = DecodeBinary(buffer);
    if (decoded.status == DecodeStatus::kNeedMore) continue;
    ASSERT_EQ(decoded.status, DecodeStatus::kMessage);
    messages.push_back(std::move(decoded.message));
    buffer.erase(0, decoded.consumed);
  }
  EXPECT_TRUE(buffer.empty());
  const std::vector<MessageVector> vectors = MessageVectors();
  ASSERT_EQ(messages.size(), vectors.size());
  for (std::size_t i = 0; i < vectors.size(); ++i) EXPECT_TRUE(SameBits(messages[i], vectors[i].message));
}

TEST(BinaryCodec, ConsumesOnlyTheFirstOfTwoFrames) {
  const std::string one = Frame({.error = 0, .text = "a", .command = 6, .params = {}, .data = {}});
  const Decoded decoded = DecodeBinary(one + one);
  EXPECT_EQ(decoded.status, DecodeStatus::kMessage);
  EXPECT_EQ(decoded.consumed, one.size());
}

TEST(BinaryCodec, EncodingAppends) {
  std::string out = "CDS1";
  EncodeBinary({}, out);
  EXPECT_TRUE(out.starts_with("CDS1"));
  EXPECT_EQ(out.size(), 4u + 24u);
}

TEST(BinaryCodec, AScenarioMayBeLargerThanOtherRequests) {
  const std::string bytes = Frame(LoadScenario(kMaxRequestBytes + 1));
  const Decoded decoded = DecodeBinary(bytes);
  EXPECT_EQ(decoded.status, DecodeStatus::kMessage);
  EXPECT_EQ(decoded.message.text.size(), kMaxRequestBytes + 1);
}

TEST(BinaryCodec, ALargeFrameWaitsForItsCommandBeforeItIsRefused) {
  Message message = LoadScenario(kMaxRequestBytes);
  message.command = command::kHello;
  const std::string bytes = Frame(message);
  EXPECT_EQ(DecodeBinary(bytes.substr(0, 11)).status, DecodeStatus::kNeedMore);
  const Decoded decoded = DecodeBinary(bytes.substr(0, 12));
  EXPECT_EQ(decoded.status, DecodeStatus::kFatal);
  EXPECT_EQ(decoded.message.error, 8);
}

TEST(BinaryCodec, TheLargestFrameIsExactlyTheLimit) {
  Message message = LoadScenario(kMaxRequestBytes - 20);
  message.command = command::kHello;
  EXPECT_EQ(DecodeBinary(Frame(message)).status, DecodeStatus::kMessage);
  message.text += 'x';
  EXPECT_EQ(DecodeBinary(Frame(message)).status, DecodeStatus::kFatal);
}

TEST(BinaryCodec, AScenarioBeyondItsOwnLimitIsRefusedByItsFirstFourBytes) {
  const std::string bytes = Frame(LoadScenario(kMaxTextsBytes - 19));
  EXPECT_EQ(DecodeBinary(bytes.substr(0, 4)).status, DecodeStatus::kFatal);
  EXPECT_EQ(DecodeBinary(Frame(LoadScenario(kMaxTextsBytes - 20))).status, DecodeStatus::kMessage);
}

TEST(BinaryCodec, AClientMayAllowLargerReplies) {
  Message reply = LoadScenario(kMaxTextsBytes);
  reply.command = command::kGetStatus;
  const std::string bytes = Frame(reply);
  EXPECT_EQ(DecodeBinary(bytes).status, DecodeStatus::kFatal);
  EXPECT_EQ(DecodeBinary(bytes, kMaxReplyBytes).status, DecodeStatus::kMessage);
}

TEST(BinaryCodec, TheFrameAfterABadTextIsReadAsUsual) {
  const std::string bad = BadBinaryVectors().back().bytes;  // text with 0xff
  const std::string good = Frame({.error = 0, .text = "", .command = 2, .params = {}, .data = {}});
  const std::string stream = bad + good;
  const Decoded first = DecodeBinary(stream);
  ASSERT_EQ(first.status, DecodeStatus::kBad);
  const Decoded second = DecodeBinary(std::string_view(stream).substr(first.consumed));
  EXPECT_EQ(second.status, DecodeStatus::kMessage);
  EXPECT_EQ(second.message.command, 2);
}

TEST(BinaryCodec, RandomBytesConsumeOrNeedMoreOrEnd) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 20000; ++round) {
    std::string bytes(random() % 64, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    // Half of the rounds get a plausible size, so that the counts are read too.
    if (round % 2 == 0 && bytes.size() >= 4) {
      bytes[0] = static_cast<char>(random() % 64);
      bytes[1] = bytes[2] = bytes[3] = 0;
    }
    const Decoded decoded = DecodeBinary(bytes);
    switch (decoded.status) {
      case DecodeStatus::kNeedMore:
        EXPECT_EQ(decoded.consumed, 0u);
        break;
      case DecodeStatus::kMessage:
      case DecodeStatus::kBad:
        EXPECT_GE(decoded.consumed, 24u);
        EXPECT_LE(decoded.consumed, bytes.size());
        break;
      case DecodeStatus::kFatal:
        EXPECT_NE(decoded.message.error, 0);
        break;
      default:
        FAIL() << "not an outcome of the binary form";
    }
  }
}

TEST(BinaryCodec, ChangedBytesOfValidFramesNeverReadBeyondTheFrame) {
  std::mt19937_64 random(2);
  for (const MessageVector& vector : MessageVectors()) {
    for (int round = 0; round < 200; ++round) {
      std::string bytes = vector.binary;
      bytes[random() % bytes.size()] = static_cast<char>(random());
      const Decoded decoded = DecodeBinary(bytes);
      EXPECT_LE(decoded.consumed, bytes.size());
    }
  }
}

}  // namespace
}  // namespace coopdyn
