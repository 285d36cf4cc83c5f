// SPDX-License-Identifier: MIT
// Complements the vectors: streams, limits, random bytes, help and verbose.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "protocol/module_tables.h"
#include "protocol/text_scan.h"
#include "vectors.h"

namespace coopdyn {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

TEST(TextCodec, BytesFedOneByOneGiveTheSameLines) {
  const CommandTable table = MotorsTable();
  const std::string stream = "# hi\n\xff\xfb\x18stop\r\nset_velocity 0.2 0.5\nnonsense\nready 3\n";
  std::vector<Message> messages;
  std::string buffer;
  for (const char byte : stream) {
    buffer += byte;
    Decoded decoded = DecodeText(buffer, table, false);
    if (decoded.status == DecodeStatus::kNeedMore) continue;
    EXPECT_EQ(decoded.consumed, buffer.size());
    buffer.erase(0, decoded.consumed);
    if (decoded.status != DecodeStatus::kNothing) messages.push_back(std::move(decoded.message));
  }
  ASSERT_EQ(messages.size(), 4u);
  EXPECT_EQ(messages[0].command, 14);
  EXPECT_EQ(messages[1].data, (std::vector<double>{0.2, 0.5}));
  EXPECT_EQ(messages[2].error, 1);
  EXPECT_EQ(messages[3].params, std::vector<std::int32_t>{3});
}

TEST(TextCodec, ConsumesOnlyTheFirstOfTwoLines) {
  EXPECT_EQ(DecodeText("stop\nready\n", MotorsTable(), false).consumed, 5u);
}

TEST(TextCodec, ALineMayHoldExactlyOneMebibyte) {
  const CommandTable table = MotorsTable();
  const std::string line = "hello " + std::string(kMaxRequestBytes - 6, 'x');
  EXPECT_EQ(DecodeText(line + "\n", table, false).status, DecodeStatus::kMessage);
  EXPECT_EQ(DecodeText(line + "\r\n", table, false).status, DecodeStatus::kMessage);
  EXPECT_EQ(DecodeText(line + "\r", table, false).status, DecodeStatus::kNeedMore);
}

TEST(TextCodec, ALongerLineIsFatalEvenBeforeItsEnd) {
  const CommandTable table = MotorsTable();
  const std::string line = "hello " + std::string(kMaxRequestBytes - 5, 'x');
  for (const std::string& bytes : {line + "\n", line + "\r\n", line + "y", line + "yyyy"}) {
    const Decoded decoded = DecodeText(bytes, table, false);
    EXPECT_EQ(decoded.status, DecodeStatus::kFatal);
    EXPECT_EQ(decoded.message.error, 8);
    EXPECT_EQ(decoded.message.command, -2);
  }
}

TEST(TextCodec, RandomLinesConsumeThemselves) {
  const std::vector<CommandTable> tables = AllModuleTables();
  // Mostly characters of the grammar, so that all of its branches are reached.
  const std::string alphabet =
      "set_velocity get_target 0123456789..--++ee\"\"\\\\()()  \t#,;\xff\xfa\xfb\x08\x7f\x00\r";
  std::mt19937_64 random(5);
  for (int round = 0; round < 30000; ++round) {
    std::string line;
    const CommandTable& table = tables[random() % tables.size()];
    if (round % 3 != 0) line = table.commands()[random() % table.commands().size()].name + " ";
    for (std::size_t n = random() % 24; n > 0; --n) {
      line += round % 5 == 0 ? static_cast<char>(random()) : alphabet[random() % alphabet.size()];
    }
    line += '\n';
    const Decoded decoded = DecodeText(line, table, round % 7 == 0);
    EXPECT_EQ(decoded.consumed, line.find('\n') + 1);
    EXPECT_NE(decoded.status, DecodeStatus::kNeedMore);
    EXPECT_NE(decoded.status, DecodeStatus::kFatal);
    EXPECT_TRUE(IsCleanUtf8(decoded.message.text));
    if (decoded.status == DecodeStatus::kBad) {
      EXPECT_NE(decoded.message.error, 0);
      EXPECT_FALSE(decoded.message.text.empty());
    }
  }
}

TEST(TextCodec, WhatIsEncodedReadsBack) {
  const CommandTable table = PoseTable();
  std::mt19937_64 random(6);
  for (int round = 0; round < 2000; ++round) {
    Message message{.error = static_cast<std::int32_t>(random()),
                    .text = "",
                    .command = static_cast<std::int32_t>(random()),
                    .params = {},
                    .data = {}};
    for (std::size_t n = random() % 20; n > 0; --n) message.text += " \t\n\r\"\\aé#("[random() % 10];
    if (!IsCleanUtf8(message.text)) message.text = "é";
    for (std::size_t n = random() % 5; n > 0; --n)
      message.params.push_back(static_cast<std::int32_t>(random()));
    for (std::size_t n = random() % 5; n > 0; --n) message.data.push_back(std::bit_cast<double>(random()));
    std::string line;
    EncodeText(message, line);
    EXPECT_EQ(line.find('\n'), line.size() - 1);
    const Decoded decoded = DecodeText(line, table, false);
    EXPECT_EQ(decoded.status, DecodeStatus::kMessage) << line;
    EXPECT_TRUE(SameBits(decoded.message, message)) << line;
  }
}

TEST(TextCodec, ControlCharactersOfATextCannotReachATerminal) {
  std::string line;
  EncodeText({.error = 0, .text = "a\x1b[2J\x08\x7f", .command = 6, .params = {}, .data = {}}, line);
  EXPECT_EQ(line, "0 \"a?[2J??\" 6 0 0\n");
}

TEST(TextCodec, UnfinishedNegotiationIsNoUtf8) {
  const CommandTable table = MotorsTable();
  for (const char* line : {"stop\xff\n", "stop\xff\xfb\n", "stop\xff\xfa\x18xterm\n", "stop\xff\xff\n"}) {
    const Decoded decoded = DecodeText(line, table, false);
    EXPECT_EQ(decoded.status, DecodeStatus::kBad);
    EXPECT_EQ(decoded.message.error, 7);
  }
}

TEST(TextCodec, ManyUnfinishedNegotiationsTakeLinearTime) {
  std::string line;
  while (line.size() < 900000) line += "\xff\xfa";
  EXPECT_EQ(TidyLine(line), line);
}

TEST(TextCodec, AFirstTextTokenMayStandBeforeTheValues) {
  // No module of robots uses it, later ones do.
  const CommandTable table(
      "made_up", {{.id = 150,
                   .name = "add",
                   .help = "Adds a thing.",
                   .text = TextUse::kFirst,
                   .text_name = "NAME",
                   .params = {{.name = "kind", .unit = "", .enums = {{"box", 1}, {"ball", 2}}}},
                   .data = {{.name = "x", .unit = "m"}, {.name = "y", .unit = "m", .optional = true}},
                   .example = "add crate box 1 2"}});
  const auto read = [&table](const std::string& line) {
    return DecodeText(line + "\n", table, false).message;
  };
  EXPECT_EQ(read("add crate box 1 2"),
            (Message{.error = 0, .text = "crate", .command = 150, .params = {1}, .data = {1, 2}}));
  EXPECT_EQ(read("add \"a crate\" ball 1"),
            (Message{.error = 0, .text = "a crate", .command = 150, .params = {2}, .data = {1}}));
  EXPECT_EQ(read("add box 1"), (Message{.error = 0, .text = "", .command = 150, .params = {1}, .data = {1}}));
  EXPECT_EQ(read("add (2) crate 1"),
            (Message{.error = 0, .text = "crate", .command = 150, .params = {2}, .data = {1}}));
  EXPECT_EQ(read("add crate cone 1").error, 2);
  EXPECT_EQ(read("add crate box").error, 3);
}

TEST(TextCodec, ARowInBracketsStandsForItsValues) {
  const CommandTable table = MotorsTable();
  const auto read = [&table](const std::string& line) {
    return DecodeText(line + "\n", table, false).message;
  };
  const Message wanted = read("set_velocity 0.2 0.5");
  for (const char* line :
       {"set_velocity [0.2 0.5]", "set_velocity [0.2, 0.5]", "set_velocity [ 0.2,0.5 ] "}) {
    EXPECT_EQ(read(line), wanted) << line;
  }
  EXPECT_EQ(read("set_velocity (10) [0.2 0.5]"), read("set_velocity (10) 0.2 0.5"));
  EXPECT_EQ(read("ready [10]"), read("ready 10"));
  EXPECT_THAT(read("set_velocity [0.2 0.5").text, HasSubstr("closing bracket ] is missing"));
  EXPECT_THAT(read("set_velocity [0.2] 0.5").text, HasSubstr("nothing may follow the closing bracket ]"));
  EXPECT_EQ(read("set_velocity []").error, 3);
}

TEST(TextCodec, ACommandOfAnotherModuleIsNamed) {
  EXPECT_EQ(DecodeText("get_pose\n", MotorsTable(), false).message.text,
            "unknown command 'get_pose': it is a command of pose, not of motors (help lists all of motors)");
}

TEST(TextCodec, AWordThatComesTooEarlyIsPutInItsPlace) {
  EXPECT_EQ(DecodeText("subscribe get_limits\n", MotorsTable(), false).message.text,
            "subscribe takes every before 'get_limits': subscribe 1 get_limits");
  EXPECT_THAT(DecodeText("subscribe get_image\n", CameraTable(), false).message.text,
              HasSubstr("get_image is not pushed; ask for each picture with get_image"));
  EXPECT_THAT(DecodeText("subscribe often\n", MotorsTable(), false).message.text,
              HasSubstr("needs a reading: get_wheels (12) or get_limits (13), not 'often'"));
}

TEST(TextCodec, AFarewellIsTakenInCapitals) {
  EXPECT_EQ(DecodeText("QUIT\n", MotorsTable(), false).status, DecodeStatus::kLeave);
  EXPECT_THAT(DecodeText("QUIT\n", SimulationTable(), false).message.text, HasSubstr("did you mean quit?"));
}

TEST(TextCodec, VerboseNamesValuesAndUnits) {
  std::string line;
  EncodeVerbose({.error = 0, .text = "", .command = 40, .params = {}, .data = {1, 2, 0.5, 0.1, 0, 0.25, 25}},
                PoseTable(), line);
  EXPECT_EQ(line,
            "# get_pose: x 1.0 m, y 2.0 m, heading 0.5 rad, forward 0.1 m/s, turn 0.0 rad/s, time_s 0.25 s, "
            "step 25\n");
}

TEST(TextCodec, VerboseNumbersRepeatedValuesAndSaysTheMode) {
  std::string line;
  EncodeVerbose(
      {.error = 0, .text = "", .command = -30, .params = {4, 7}, .data = {1, 0.5, 2, -0.5, 0.25, 25}},
      TargetTable(), line);
  EXPECT_EQ(line,
            "# get_targets: id[1] 4, id[2] 7, distance[1] 1.0 m, bearing[1] 0.5 rad, distance[2] 2.0 m, "
            "bearing[2] -0.5 "
            "rad, time_s 0.25 s, step 25\n");
  line.clear();
  EncodeVerbose({.error = 0, .text = "", .command = 11, .params = {1}, .data = {0.25, 25}}, MotorsTable(),
                line);
  EXPECT_EQ(line, "# set_velocity: mode 1 (lockstep), time_s 0.25 s, step 25\n");
}

TEST(TextCodec, VerboseTakesAnyReply) {
  const CommandTable table = MotorsTable();
  for (const std::int32_t id : {-2147483647 - 1, -40, -2, 0, 11, 99}) {
    for (std::size_t n = 0; n < 4; ++n) {
      std::string line;
      EncodeVerbose(
          {.error = 0, .text = "", .command = id, .params = {1, 2, 3}, .data = std::vector<double>(n, 1)},
          table, line);
      EXPECT_TRUE(line.starts_with("# ")) << line;
      EXPECT_THAT(line, EndsWith("\n"));
    }
  }
  std::string line;
  EncodeVerbose(ErrorReply(11, Error::kOwned, "owned by ana"), table, line);
  EXPECT_EQ(line, "# set_velocity: error 6, owned by another client\n");
}

TEST(TextCodec, VerboseAddsNothingToAFarewell) {
  std::string line;
  EncodeVerbose({.error = 0, .text = "goodbye", .command = -1, .params = {}, .data = {}}, MotorsTable(),
                line);
  EXPECT_EQ(line, "");
}

TEST(TextCodec, HelpIsMadeOfCommentsAndNamesEveryCommand) {
  for (const CommandTable& table : AllModuleTables()) {
    const std::string help = HelpText(table);
    for (const CommandSpec& spec : table.commands()) EXPECT_THAT(help, HasSubstr("#   " + spec.name));
    std::size_t start = 0;
    while (start < help.size()) {
      const std::size_t end = help.find('\n', start);
      ASSERT_NE(end, std::string::npos);
      EXPECT_EQ(help[start], '#');
      start = end + 1;
    }
  }
}

}  // namespace
}  // namespace coopdyn
