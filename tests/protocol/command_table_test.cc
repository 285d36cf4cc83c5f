// SPDX-License-Identifier: MIT
#include "protocol/command_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/json.hpp>
#include <cmath>
#include <set>

#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "protocol/common_commands.h"
#include "protocol/json_text.h"
#include "protocol/module_tables.h"
#include "protocol/usage.h"

namespace coopdyn {
namespace {

namespace json = boost::json;
using ::testing::HasSubstr;

TEST(CommandTables, IdsAreUniqueAcrossModulesAndNamesWithinExceptTheCommonOnes) {
  std::set<std::int32_t> ids;
  for (const CommandTable& table : AllModuleTables()) {
    std::set<std::string> names;
    for (const CommandSpec& spec : table.commands().subspan(kCommonCommandCount)) {
      EXPECT_TRUE(ids.insert(spec.id).second) << spec.id;
      EXPECT_TRUE(names.insert(spec.name).second) << spec.name;
      EXPECT_GE(spec.id, 10);
    }
  }
}

TEST(CommandTables, BeginWithTheCommonCommands) {
  for (const CommandTable& table : AllModuleTables()) {
    for (std::int32_t id = 0; id < 10; ++id) EXPECT_EQ(table.commands()[static_cast<std::size_t>(id)].id, id);
  }
}

TEST(CommandTables, NamesAreWords) {
  for (const CommandTable& table : AllModuleTables()) {
    for (const CommandSpec& spec : table.commands()) {
      EXPECT_EQ(spec.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string::npos)
          << spec.name;
      EXPECT_TRUE(spec.name[0] >= 'a' && spec.name[0] <= 'z') << spec.name;
      EXPECT_NE(spec.name, "help");
      EXPECT_NE(spec.name, "verbose");
      EXPECT_TRUE(spec.help.ends_with('.')) << spec.name;
    }
  }
}

TEST(CommandTables, EveryExampleIsARequestOfItsCommand) {
  for (const CommandTable& table : AllModuleTables()) {
    for (const CommandSpec& spec : table.commands()) {
      for (CommandSpec copy : {spec, [&spec] {
                                 CommandSpec made = spec;
                                 made.example.clear();
                                 return made;
                               }()}) {
        const Decoded decoded = DecodeText(ExampleLine(copy) + "\n", table, false);
        EXPECT_EQ(decoded.status, DecodeStatus::kMessage)
            << ExampleLine(copy) << ": " << decoded.message.text;
        EXPECT_EQ(decoded.message.command, spec.id) << ExampleLine(copy);
      }
    }
  }
}

TEST(CommandTables, ActuatorCommandsAndReadyTakeStepsAndTellTheMode) {
  const CommandTable table = MotorsTable();
  for (const char* name : {"set_wheel_speeds", "set_velocity", "stop", "ready"}) {
    const CommandSpec* spec = table.Find(name);
    ASSERT_NE(spec, nullptr);
    ASSERT_EQ(spec->params.size(), 1u) << name;
    EXPECT_EQ(spec->params[0].name, "steps");
    EXPECT_TRUE(spec->params[0].optional);
    ASSERT_FALSE(spec->reply_params.empty());
    EXPECT_EQ(spec->reply_params[0].name, "mode");
  }
}

TEST(CommandTables, SubscribeKnowsTheReadingsOfItsModule) {
  const auto readings = [](const CommandTable& table) {
    return table.Find(command::kSubscribe)->params[1].enums;
  };
  EXPECT_THAT(readings(MotorsTable()),
              ::testing::ElementsAre(std::pair("get_wheels", 12), std::pair("get_limits", 13)));
  EXPECT_THAT(readings(TargetTable()),
              ::testing::ElementsAre(std::pair("get_targets", 30), std::pair("get_robots", 32)));
  EXPECT_THAT(readings(SimulationTable()),
              ::testing::ElementsAre(std::pair("get_status", 100), std::pair("get_saved", 196),
                                     std::pair("get_clock", 189)));
  EXPECT_THAT(readings(RecorderTable()), ::testing::ElementsAre(std::pair("get_recording", 120)));
  EXPECT_THAT(readings(PlaybackTable()), ::testing::ElementsAre(std::pair("get_playback", 130)));
}

TEST(CommandTables, FindByIdAndNameAgree) {
  const CommandTable table = PoseTable();
  EXPECT_EQ(table.Find(40), table.Find("get_pose"));
  EXPECT_EQ(table.Find(39), nullptr);
  EXPECT_EQ(table.Find("get_pos"), nullptr);
}

TEST(CommandTables, NearestFindsSlipsAndPartsAndNothingFarAway) {
  const CommandTable table = MotorsTable();
  EXPECT_EQ(table.Nearest("set_velosity"), "set_velocity");
  EXPECT_EQ(table.Nearest("setVelocity"), "set_velocity");
  EXPECT_EQ(table.Nearest("set-velocity"), "set_velocity");
  EXPECT_EQ(table.Nearest("sotp"), "stop");
  EXPECT_EQ(table.Nearest("velocity"), "set_velocity");
  EXPECT_EQ(table.Nearest("xyzzyx"), "");
  EXPECT_EQ(table.Nearest(std::string(100000, 's')), "");
}

CheckResult Check(const char* name, std::string_view text, std::vector<std::int32_t> params,
                  std::vector<double> data) {
  for (const CommandTable& table : AllModuleTables()) {
    if (const CommandSpec* spec = table.Find(name)) return CheckRequest(*spec, text, params, data);
  }
  return {-1, "no such command"};
}

TEST(CheckRequest, AcceptsWhatTheSpecSays) {
  EXPECT_EQ(Check("set_velocity", "", {}, {0.2, 0.5}).error, 0);
  EXPECT_EQ(Check("set_velocity", "", {1}, {0.2, 0.5}).text, "");
  EXPECT_EQ(Check("ping", "", {1, 2, 3}, {1, NAN, INFINITY}).error, 0);
  EXPECT_EQ(Check("get_target", "red", {}, {}).error, 0);
  EXPECT_EQ(Check("get_target", "", {1}, {}).error, 0);
  EXPECT_EQ(Check("set_speed", "", {}, {-1}).error, 0);
  EXPECT_EQ(Check("reset", "", {-5}, {}).error, 0);
  EXPECT_EQ(Check("attach", "", {}, {}).error, 0);
}

TEST(CheckRequest, CountsOfParamsAreError2AndOfDataError3) {
  EXPECT_EQ(Check("set_velocity", "", {1, 2}, {0.2, 0.5}).error, 2);
  EXPECT_EQ(Check("set_velocity", "", {}, {0.2}).error, 3);
  EXPECT_EQ(Check("set_velocity", "", {}, {}).error, 3);
  EXPECT_EQ(Check("set_velocity", "", {}, {1, 2, 3}).error, 3);
  EXPECT_EQ(Check("get_pose", "", {1}, {}).error, 2);
  EXPECT_EQ(Check("get_pose", "", {}, {1}).error, 3);
  EXPECT_EQ(Check("step", "", {}, {}).error, 2);
  EXPECT_EQ(Check("step", "", {}, {1}).error, 2);
  EXPECT_EQ(Check("step", "", {1}, {1}).error, 3);
  EXPECT_EQ(Check("set_step", "", {1}, {0.01}).error, 2);
}

TEST(CheckRequest, TextsWhereNoneBelongOrNoneAreGivenAreError2) {
  EXPECT_EQ(Check("stop", "now", {}, {}).error, 2);
  EXPECT_EQ(Check("hello", "", {}, {}).error, 2);
  EXPECT_EQ(Check("get_target", "", {}, {}).error, 2);
  EXPECT_EQ(Check("get_target", "red", {1}, {}).error, 2);
}

TEST(CheckRequest, NumbersOutOfRangeAreError4) {
  EXPECT_EQ(Check("set_velocity", "", {}, {0.2, NAN}).error, 4);
  EXPECT_EQ(Check("set_velocity", "", {}, {INFINITY, 0}).error, 4);
  EXPECT_EQ(Check("set_velocity", "", {0}, {0.2, 0.5}).error, 4);
  EXPECT_EQ(Check("ready", "", {-1}, {}).error, 4);
  EXPECT_EQ(Check("set_mode", "", {3}, {}).error, 4);
  EXPECT_EQ(Check("subscribe", "", {1, 11}, {}).error, 4);
}

TEST(CheckRequest, ErrorsSayWhatToWrite) {
  EXPECT_EQ(Check("set_velocity", "", {}, {0.2}).text,
            "set_velocity takes linear (m/s) and angular (rad/s): set_velocity 0.2 0.5");
  EXPECT_EQ(Check("set_mode", "", {3}, {}).text,
            "set_mode needs a mode: realtime (0), lockstep (1) or free (2), not 3: set_mode lockstep");
  EXPECT_EQ(Check("step", "", {0}, {}).text, "step needs steps from 1 to 10000000, not 0: step 10");
  EXPECT_EQ(Check("ready", "", {20000000}, {}).text,
            "ready needs steps from 1 to 10000000, not 20000000: ready 10");
  EXPECT_EQ(Check("send_message", "", {}, {}).text, "send_message takes 1 to 8 numbers: send_message 1 0.5");
}

TEST(CheckRequest, EveryErrorEndsWithALineThatWorks) {
  for (const CommandTable& table : AllModuleTables()) {
    for (const CommandSpec& spec : table.commands()) {
      const std::vector<std::int32_t> params(50, -1);
      const CheckResult result = CheckRequest(spec, "", params, {});
      if (result.error == 0) continue;
      EXPECT_TRUE(result.text.ends_with(": " + ExampleLine(spec))) << result.text;
    }
  }
}

TEST(CheckRequest, RepeatedValuesComeInWholeGroups) {
  const CommandSpec spec{.id = 150,
                         .name = "drive",
                         .help = "",
                         .params = {{.name = "robot", .unit = "", .repeated = true}},
                         .data = {{.name = "first", .unit = ""},
                                  {.name = "linear", .unit = "m/s", .repeated = true},
                                  {.name = "angular", .unit = "rad/s", .repeated = true}}};
  const auto check = [&spec](std::size_t n) {
    return CheckRequest(spec, "", {}, std::vector<double>(n, 1.0)).error;
  };
  EXPECT_EQ(check(0), 3);
  EXPECT_EQ(check(1), 0);
  EXPECT_EQ(check(2), 3);
  EXPECT_EQ(check(3), 0);
  EXPECT_EQ(check(5), 0);
}

TEST(Describe, IsJsonWithTheSameKeysInEveryObject) {
  for (const CommandTable& table : AllModuleTables()) {
    const json::object root = json::parse(table.DescribeJson("1.2.3")).as_object();
    EXPECT_EQ(root.at("protocol").as_int64(), 1);
    EXPECT_EQ(root.at("version").as_string(), "1.2.3");
    EXPECT_EQ(root.at("module").as_string(), table.module());
    const json::array& commands = root.at("commands").as_array();
    ASSERT_EQ(commands.size(), table.commands().size());
    std::set<std::set<std::string>> command_keys;
    std::set<std::set<std::string>> value_keys;
    const auto keys = [](const json::object& object) {
      std::set<std::string> names;
      for (const auto& entry : object) names.emplace(entry.key());
      return names;
    };
    for (const json::value& command : commands) {
      command_keys.insert(keys(command.as_object()));
      for (const char* list : {"params", "data", "reply_params", "reply_data"}) {
        for (const json::value& value : command.at(list).as_array())
          value_keys.insert(keys(value.as_object()));
      }
    }
    for (const json::value& value : root.at("reply_data_end").as_array())
      value_keys.insert(keys(value.as_object()));
    EXPECT_EQ(command_keys.size(), 1u);
    EXPECT_EQ(value_keys.size(), 1u);
  }
}

TEST(Describe, TellsNamesUnitsAndWords) {
  const json::value root = json::parse(MotorsTable().DescribeJson("0"));
  const json::value& velocity = root.at("commands").as_array().at(11);
  EXPECT_EQ(velocity.at("id").as_int64(), 11);
  EXPECT_EQ(velocity.at("data").at(0).at("name").as_string(), "linear");
  EXPECT_EQ(velocity.at("data").at(1).at("unit").as_string(), "rad/s");
  EXPECT_TRUE(velocity.at("params").at(0).at("optional").as_bool());
  EXPECT_EQ(velocity.at("reply_params").at(0).at("enums").at(1).at("word").as_string(), "lockstep");
  EXPECT_TRUE(velocity.at("data").at(0).at("min").is_null());
}

TEST(JsonText, StringsReadBack) {
  const std::string text = "a\"b\\c\n\r\t\x01\x1f\x7f</script>&é€🤖";
  EXPECT_EQ(json::value_to<std::string>(json::parse(JsonText(json::string(text)))), text);
  EXPECT_THAT(JsonText(json::string(text)), ::testing::Not(HasSubstr("<")));
}

TEST(JsonText, BytesThatAreNotUtf8AreReplaced) {
  EXPECT_EQ(JsonText("a\xff"
                     "b\xe2\x82"),
            "\"a\xEF\xBF\xBD"
            "b\xEF\xBF\xBD\xEF\xBF\xBD\"");
}

TEST(JsonText, NumbersReadAsInTheTextEncoding) {
  EXPECT_EQ(JsonText(json::array{0.5, 0.01, 3.0, -1, 7u, NAN, -INFINITY}), "[0.5,0.01,3.0,-1,7,null,null]");
}

TEST(JsonText, ObjectsKeepTheirOrder) {
  EXPECT_EQ(JsonText(json::object{{"z", nullptr}, {"a", json::array{}}, {"m", json::object{{"b", true}}}}),
            R"({"z":null,"a":[],"m":{"b":true}})");
}

TEST(Utf8, AcceptsTheBordersOfEachLength) {
  for (const char* text : {"\x01", "\x7f", "\u0080", "\u07ff", "\u0800", "\ud7ff", "\ue000", "\uffff",
                           "\U00010000", "\U0010ffff"}) {
    EXPECT_TRUE(IsCleanUtf8(text)) << text;
  }
}

TEST(Utf8, RefusesWhatRfc3629Refuses) {
  for (const char* text : {"\x80", "\xc0\x80", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xed\xbf\xbf",
                           "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xfe", "\xff", "\xc3",
                           "\xe2\x82", "\xf0\x9f\xa4", "\xc3\x28"}) {
    EXPECT_FALSE(IsCleanUtf8(text));
  }
  EXPECT_FALSE(IsCleanUtf8(std::string_view("\0", 1)));
}

TEST(ReadingCommands, ChangeNothing) {
  for (const char* name : {"get_pose", "get_status", "read_all", "select_readings", "describe", "ping",
                           "subscribe", "attach", "list"}) {
    EXPECT_TRUE(IsReadingCommand(name)) << name;
  }
  for (const char* name : {"set_velocity", "run", "ready", "claim", "hello", "release_robot", "stop", ""}) {
    EXPECT_FALSE(IsReadingCommand(name)) << name;
  }
}

}  // namespace
}  // namespace coopdyn
