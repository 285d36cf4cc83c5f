// SPDX-License-Identifier: MIT
// Requests eight times as long take about eight times as long to read and to write.
#include <gtest/gtest.h>

#include <string>

#include "protocol/codec.h"
#include "protocol/module_tables.h"
#include "tests/cpu.h"

namespace coopdyn {
namespace {

using Kind = GrowingText;

class LinearTextTest : public testing::TestWithParam<Kind> {};

TEST_P(LinearTextTest, Reading) {
  const CommandTable& table = AllModuleTables().front();
  const auto read = [&](std::size_t n) {
    const std::string text = GetParam().Of(n);
    for (std::string_view rest = text; !rest.empty();) {
      const Decoded decoded = DecodeText(rest, table, false);
      if (decoded.consumed == 0) break;
      rest.remove_prefix(decoded.consumed);
    }
  };
  ExpectLinear(read, 100'000 / GetParam().part.size());
}

INSTANTIATE_TEST_SUITE_P(
    OfLines, LinearTextTest,
    testing::Values(Kind{"words", "get_pose ", "1 ", "\n"}, Kind{"data", "0 \"\" 11 0 50000 ", "1.5 ", "\n"},
                    Kind{"params", "0 \"\" 11 50000 ", "7 ", "\n"}, Kind{"text", "0 \"", "x", "\" 11 0 0\n"},
                    Kind{"escapes", "0 \"", "\\n", "\" 11 0 0\n"}, Kind{"quotes", "log ", "\"", "\n"},
                    Kind{"spaces", "", " ", "\n"}, Kind{"one word", "", "x", "\n"},
                    Kind{"a long number", "", "1", "\n"}, Kind{"UTF-8", "log \"", "\xC3\xA4", "\"\n"},
                    Kind{"Telnet's commands", "", "\xFF\xFD\x01", "\n"},
                    Kind{"Telnet's negotiation without end", "", "\xFF\xFA", "\n"},
                    Kind{"backspaces", "", "a\b", "\n"}, Kind{"empty lines", "", "\n", ""},
                    Kind{"comments", "", "# x\n", ""},
                    Kind{"unknown words", "", "get_posse" + std::string(90, ' ') + "\n", ""},
                    Kind{"lines", "", "get_pose\n", ""}));

TEST(LinearBinaryTest, ReadingAndWriting) {
  const auto both = [](std::size_t n) {
    Message message;
    message.text.assign(n, 'x');
    message.params.assign(n / 8, 7);
    message.data.assign(n / 16, 1.5);
    std::string bytes;
    EncodeBinary(message, bytes);
    EXPECT_EQ(DecodeBinary(bytes, 2 * bytes.size()).status, DecodeStatus::kMessage);
  };
  ExpectLinear(both, 1'000'000);
}

TEST(LinearBinaryTest, FramesOfAStream) {
  const auto read = [](std::size_t n) {
    std::string bytes;
    for (std::size_t i = 0; i < n; ++i) EncodeBinary(Message{}, bytes);
    for (std::string_view rest = bytes; !rest.empty();) rest.remove_prefix(DecodeBinary(rest).consumed);
  };
  ExpectLinear(read, 20'000);
}

TEST(LinearTextWritingTest, Replies) {
  const auto write = [](std::size_t n) {
    Message message;
    message.text.assign(n, '"');
    message.data.assign(n / 16, 1.0 / 3);
    std::string text;
    EncodeText(message, text);
  };
  ExpectLinear(write, 200'000);
}

}  // namespace
}  // namespace coopdyn
