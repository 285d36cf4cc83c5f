// SPDX-License-Identifier: MIT
// docs/protocol.md against the command tables and codecs: the document cannot deviate from the daemon.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "protocol/common_commands.h"
#include "protocol/module_tables.h"
#include "protocol/usage.h"
#include "tests/source_dir.h"
#include "vectors.h"

namespace coopdyn {
namespace {

using ::testing::ElementsAreArray;

const std::string& Doc() {
  static const std::string doc = ReadWholeFile(SourceDir() + "/docs/protocol.md");
  return doc;
}

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The lines from `heading` to the next heading.
std::vector<std::string> Section(const std::string& heading) {
  std::vector<std::string> section;
  bool inside = false;
  for (const std::string& line : LinesOf(Doc())) {
    if (line.starts_with("## ") || line.starts_with("### ")) inside = line == heading;
    if (inside) section.push_back(line);
  }
  return section;
}

/// The rows of the tables of a section that begin with a number.
std::vector<std::string> NumberedRows(const std::string& heading) {
  std::vector<std::string> rows;
  for (const std::string& line : Section(heading)) {
    if (line.starts_with("| ") && line.size() > 2 && line[2] >= '0' && line[2] <= '9') rows.push_back(line);
  }
  return rows;
}

std::string TextCell(const CommandSpec& spec) {
  if (spec.text == TextUse::kNone) return "–";
  if (spec.text == TextUse::kOrNumber) return "or " + spec.text_name;
  return spec.text_optional || spec.text == TextUse::kFirst ? "[" + spec.text_name + "]" : spec.text_name;
}

std::string Row(const CommandSpec& spec) {
  return "| " + std::to_string(spec.id) + " | `" + spec.name + "` | " + TextCell(spec) + " | " +
         ValuesCell(spec.params, true) + " | " + ValuesCell(spec.data, true) + " | " +
         ValuesCell(spec.reply_params) + " | " + ValuesCell(spec.reply_data) + " | " +
         (spec.reply_text.empty() ? "–" : spec.reply_text) + " | " + spec.help + " |";
}

std::vector<std::string> Rows(std::span<const CommandSpec> commands) {
  std::vector<std::string> rows;
  for (const CommandSpec& spec : commands) rows.push_back(Row(spec));
  return rows;
}

std::string Joined(const std::vector<std::string>& rows) {
  std::string text = "the rows should be:\n";
  for (const std::string& row : rows) text += row + "\n";
  return text;
}

/// The lines of the code block after the marker `<!-- NAME -->`.
std::vector<std::string> Block(const std::string& name) {
  std::vector<std::string> block;
  int fences = -1;
  for (const std::string& line : LinesOf(Doc())) {
    if (line == "<!-- " + name + " -->") fences = 0;
    if (fences == 1 && !line.starts_with("```")) block.push_back(line);
    if (fences >= 0 && line.starts_with("```")) ++fences;
    if (fences == 2) break;
  }
  return block;
}

TEST(ProtocolDoc, ListsTheCommonCommands) {
  const std::vector<std::string> expected = Rows(CommonCommands({}));
  EXPECT_THAT(NumberedRows("### Every module"), ElementsAreArray(expected)) << Joined(expected);
}

TEST(ProtocolDoc, ListsTheCommandsOfEachModule) {
  std::map<std::int32_t, CommandSpec> common;
  for (const CommandSpec& spec : CommonCommands({})) common.emplace(spec.id, spec);
  for (const CommandTable& table : AllModuleTables()) {
    const bool is_global = table.module() == "simulation" || table.module() == "swarm" ||
                           table.module() == "world" || table.module() == "recorder" ||
                           table.module() == "playback";
    const std::string name = (is_global ? "/" : "/R/") + table.module();
    std::vector<std::string> expected;
    for (const CommandSpec& spec : table.commands()) {
      // Common commands that this module declares differently; subscribe differs everywhere.
      const bool is_common = spec.id < static_cast<std::int32_t>(kCommonCommandCount);
      if (is_common && (spec.name.ends_with("subscribe") || Row(spec) == Row(common.at(spec.id)))) continue;
      expected.push_back(Row(spec));
    }
    EXPECT_THAT(NumberedRows("### `" + name + "`"), ElementsAreArray(expected)) << Joined(expected);
  }
}

TEST(ProtocolDoc, ListsTheErrors) {
  const std::vector<std::string> rows = NumberedRows("## Errors");
  ASSERT_EQ(rows.size(), 13u);
  for (std::int32_t error = 0; error < 13; ++error) {
    const std::string start = "| " + std::to_string(error) + " | " + std::string(ErrorMeaning(error)) + " |";
    EXPECT_TRUE(rows[static_cast<std::size_t>(error)].starts_with(start)) << start;
  }
}

TEST(ProtocolDoc, EveryNamedLineOfTheTextSectionIsReadable) {
  std::vector<std::string> lines = Block("lines: motors");
  ASSERT_FALSE(lines.empty());
  for (const std::string& line : lines) {
    const Decoded decoded = DecodeText(line.substr(0, line.find("  #")) + "\n", MotorsTable(), false);
    EXPECT_EQ(decoded.status, DecodeStatus::kMessage) << line << ": " << decoded.message.text;
  }
}

/// True if `line` is `pattern`, in which a field * stands for any number.
bool Matches(const std::string& pattern, const std::string& line) {
  std::istringstream a(pattern);
  std::istringstream b(line);
  std::string x;
  std::string y;
  while (true) {
    const bool more_a = static_cast<bool>(a >> x);
    const bool more_b = static_cast<bool>(b >> y);
    if (!more_a || !more_b) return more_a == more_b;
    if (x != "*" && x != y) return false;
  }
}

TEST(ProtocolDoc, TheTextExchangeIsWhatTheCodecSays) {
  const std::vector<std::string> lines = Block("exchange: text");
  ASSERT_GE(lines.size(), 6u);
  EXPECT_EQ(lines[0], "> OPEN /robot1/motors");
  EXPECT_EQ(lines[1], "< ok");
  for (std::size_t i = 2; i + 1 < lines.size(); i += 2) {
    ASSERT_TRUE(lines[i].starts_with("> ") && lines[i + 1].starts_with("< ")) << lines[i];
    const Decoded decoded = DecodeText(lines[i].substr(2) + "\n", MotorsTable(), false);
    Message reply = decoded.message;
    if (decoded.status == DecodeStatus::kMessage) {
      const bool actuator = reply.command >= 10 && reply.command != 12 && reply.command != 13;
      const std::vector<double> reading =
          reply.command == 12 ? std::vector<double>(6) : std::vector<double>(2);
      reply = {.error = 0,
               .text = "",
               .command = reply.command,
               .params = actuator ? std::vector<std::int32_t>{0} : std::vector<std::int32_t>{},
               .data = reading};
    }
    std::string line;
    EncodeText(reply, line);
    EXPECT_TRUE(Matches(lines[i + 1].substr(2), line)) << lines[i] << " gives " << line;
  }
}

TEST(ProtocolDoc, TheTeamsExchangeIsReadable) {
  const std::vector<std::string> lines = Block("exchange: swarm");
  ASSERT_GE(lines.size(), 6u);
  for (std::size_t i = 2; i + 1 < lines.size(); i += 2) {
    ASSERT_TRUE(lines[i].starts_with("> ") && lines[i + 1].starts_with("< ")) << lines[i];
    const Decoded decoded = DecodeText(lines[i].substr(2) + "\n", SwarmTable(), false);
    EXPECT_EQ(decoded.status, DecodeStatus::kMessage) << lines[i] << ": " << decoded.message.text;
  }
}

/// The bytes of an exchange line after its direction; `..` stands for any byte and reads as 0.
std::string HexBytes(const std::string& line) {
  std::string bytes;
  std::istringstream stream(line.substr(2, line.find('#') - 2));
  for (std::string pair; stream >> pair;) {
    bytes += pair == ".." ? '\0' : static_cast<char>(std::stoi(pair, nullptr, 16));
  }
  return bytes;
}

TEST(ProtocolDoc, TheBinaryExchangeIsWhatTheCodecSays) {
  std::string sent;
  std::string answered;
  for (const std::string& line : Block("exchange: binary")) {
    if (line.starts_with("> ")) sent += HexBytes(line);
    if (line.starts_with("< ")) answered += HexBytes(line);
  }
  const std::string open = "OPEN /robot1/motors\n";
  ASSERT_TRUE(sent.starts_with(open + "CDS1"));
  ASSERT_TRUE(answered.starts_with("ok\n"));
  std::string_view requests = std::string_view(sent).substr(open.size() + 4);
  std::string_view replies = std::string_view(answered).substr(3);
  const Decoded velocity = DecodeBinary(requests);
  EXPECT_EQ(velocity.message,
            (Message{.error = 0, .text = "", .command = 11, .params = {}, .data = {0.2, 0.5}}));
  const Decoded first = DecodeBinary(replies);
  EXPECT_EQ(first.message, (Message{.error = 0, .text = "", .command = 11, .params = {0}, .data = {0, 0}}));
  const Decoded stop = DecodeBinary(requests.substr(velocity.consumed));
  EXPECT_EQ(stop.message, (Message{.error = 0, .text = "", .command = 14, .params = {}, .data = {}}));
  const Decoded second = DecodeBinary(replies.substr(first.consumed));
  EXPECT_EQ(second.message, (Message{.error = 0, .text = "", .command = 14, .params = {0}, .data = {0, 0}}));
  EXPECT_EQ(velocity.consumed + stop.consumed, requests.size());
  EXPECT_EQ(first.consumed + second.consumed, replies.size());
}

TEST(ProtocolDoc, TheClientIsShort) {
  const std::vector<std::string> client = Block("client");
  EXPECT_GT(client.size(), 30u);
  EXPECT_LE(client.size(), 60u);
}

}  // namespace
}  // namespace coopdyn
