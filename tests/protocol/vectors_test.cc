// SPDX-License-Identifier: MIT
// The codecs against the golden vectors that every client's tests read too.
#include "vectors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <map>

#include "protocol/module_tables.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

const CommandTable& TableOf(const std::string& module) {
  static const std::vector<CommandTable> tables = AllModuleTables();
  for (const CommandTable& table : tables) {
    if (table.module() == module) return table;
  }
  throw std::runtime_error("no module " + module);
}

TEST(Vectors, ThereAreAtLeastSixty) {
  EXPECT_GE(MessageVectors().size() + BadBinaryVectors().size() + TextLineVectors().size(), 60u);
}

TEST(Vectors, MessagesEncodeToTheirBytes) {
  for (const MessageVector& vector : MessageVectors()) {
    std::string bytes;
    EncodeBinary(vector.message, bytes);
    EXPECT_EQ(bytes, vector.binary) << vector.name;
  }
}

TEST(Vectors, BytesDecodeToTheirMessages) {
  for (const MessageVector& vector : MessageVectors()) {
    const Decoded decoded = DecodeBinary(vector.binary);
    EXPECT_EQ(decoded.status, DecodeStatus::kMessage) << vector.name;
    EXPECT_EQ(decoded.consumed, vector.binary.size()) << vector.name;
    EXPECT_TRUE(SameBits(decoded.message, vector.message)) << vector.name;
  }
}

TEST(Vectors, MessagesEncodeToTheirLines) {
  for (const MessageVector& vector : MessageVectors()) {
    std::string line;
    EncodeText(vector.message, line);
    EXPECT_EQ(line, vector.text_line + "\n") << vector.name;
  }
}

TEST(Vectors, LinesDecodeToTheirMessages) {
  for (const MessageVector& vector : MessageVectors()) {
    const std::string line = vector.text_line + "\n";
    const Decoded decoded = DecodeText(line, TableOf("motors"), false);
    EXPECT_EQ(decoded.status, DecodeStatus::kMessage) << vector.name;
    EXPECT_EQ(decoded.consumed, line.size()) << vector.name;
    EXPECT_TRUE(SameBits(decoded.message, vector.message)) << vector.name;
  }
}

TEST(Vectors, BadFramesAreRefusedAsSoonAsTheyCanBe) {
  for (const BadBinaryVector& vector : BadBinaryVectors()) {
    for (std::size_t n = 0; n <= vector.bytes.size(); ++n) {
      const Decoded decoded = DecodeBinary(std::string_view(vector.bytes).substr(0, n));
      if (n < vector.needs) {
        EXPECT_EQ(decoded.status, DecodeStatus::kNeedMore) << vector.name << " at " << n;
        continue;
      }
      EXPECT_EQ(decoded.status, vector.fatal ? DecodeStatus::kFatal : DecodeStatus::kBad)
          << vector.name << " at " << n;
      EXPECT_EQ(decoded.message.error, vector.error) << vector.name;
      EXPECT_EQ(decoded.message.command, vector.command) << vector.name;
      EXPECT_FALSE(decoded.message.text.empty()) << vector.name;
      EXPECT_EQ(decoded.consumed, vector.fatal ? 0 : vector.bytes.size()) << vector.name;
    }
  }
}

TEST(Vectors, TextLinesMeanWhatTheySay) {
  for (const TextLineVector& vector : TextLineVectors()) {
    const Decoded decoded = DecodeText(vector.line, TableOf(vector.module), vector.first_line);
    EXPECT_EQ(decoded.status, vector.outcome) << vector.name << ": " << decoded.message.text;
    EXPECT_EQ(decoded.consumed, vector.line.size()) << vector.name;
    EXPECT_EQ(decoded.message.error, vector.message.error) << vector.name << ": " << decoded.message.text;
    EXPECT_EQ(decoded.message.command, vector.message.command) << vector.name << ": " << decoded.message.text;
    if (vector.outcome == DecodeStatus::kMessage) {
      EXPECT_TRUE(SameBits(decoded.message, vector.message)) << vector.name;
    } else {
      EXPECT_THAT(decoded.message.text, HasSubstr(vector.says)) << vector.name;
    }
  }
}

TEST(Vectors, TextLinesNeedTheirLineEnd) {
  for (const TextLineVector& vector : TextLineVectors()) {
    for (std::size_t n = 0; n < vector.line.size(); ++n) {
      const Decoded decoded =
          DecodeText(std::string_view(vector.line).substr(0, n), TableOf(vector.module), vector.first_line);
      EXPECT_EQ(decoded.status, DecodeStatus::kNeedMore) << vector.name << " at " << n;
      EXPECT_EQ(decoded.consumed, 0u) << vector.name << " at " << n;
    }
  }
}

TEST(Vectors, FirstBytesChooseTheEncoding) {
  for (const FirstBytesVector& vector : FirstBytesVectors()) {
    EXPECT_EQ(SniffEncoding(vector.bytes), vector.encoding) << vector.name;
  }
}

TEST(Vectors, FirstBytesNeverChangeTheirMind) {
  for (const FirstBytesVector& vector : FirstBytesVectors()) {
    if (vector.encoding == FirstBytes::kUndecided) continue;
    for (std::size_t n = 0; n < vector.bytes.size(); ++n) {
      const FirstBytes early = SniffEncoding(std::string_view(vector.bytes).substr(0, n));
      EXPECT_TRUE(early == FirstBytes::kUndecided || early == vector.encoding) << vector.name << " at " << n;
    }
  }
}

TEST(Vectors, DoublesPrintAsTheirTexts) {
  for (const DoubleVector& vector : DoubleVectors()) {
    double value = 0;
    ASSERT_EQ(vector.bytes.size(), sizeof value);
    std::memcpy(&value, vector.bytes.data(), sizeof value);
    std::string text;
    AppendDouble(value, text);
    EXPECT_EQ(text, vector.text);
  }
}

}  // namespace
}  // namespace coopdyn
