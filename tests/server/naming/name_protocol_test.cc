// SPDX-License-Identifier: MIT
// The bytes of real programs' sessions with YARP's own name server, to which ours gives the same answers.
#include "server/naming/name_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace coopdyn {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kEnd = "*** end of message\r\n";

class NameProtocolTest : public ::testing::Test {
 protected:
  NameProtocolTest() {
    table_.SetExternalPorts(11005, 11100);
    const AdoptFunction adopt = [](int, const std::string&, const PeerInfo&,
                                   const std::unique_ptr<Encoding>&) {};
    table_.AddOwn("/robot1/motors", 10002, adopt);
    table_.AddOwn("/robot1/distance", 10003, adopt);
  }
  std::string Ask(const std::string& line) { return AnswerNameLine(line, context_, table_).text; }

  NameTable table_;
  NameContext context_{"127.0.0.1", "127.0.0.1", ""};
};

TEST_F(NameProtocolTest, QueriesAnOwnName) {
  EXPECT_EQ(Ask("NAME_SERVER query /robot1/motors"),
            std::string("registration name /robot1/motors ip 127.0.0.1 port 10002 type tcp\r\n") + kEnd);
  EXPECT_EQ(Ask("query /robot1/motors\r"), Ask("NAME_SERVER query /robot1/motors"));
  EXPECT_EQ(Ask("query robot1/motors"), Ask("query \"/robot1/motors\""));
}

TEST_F(NameProtocolTest, ANameMayBeOpenedWhenItIsAskedFor) {
  std::vector<std::string> asked;
  NameHooks hooks;
  hooks.open = [&](const std::string& name, const std::string& /*asker*/) {
    asked.push_back(name);
    if (name == "/robot1/pose/state:o") table_.AddOwn(name, 40001, nullptr, NameKind::kAlias);
  };
  context_.hooks = &hooks;
  EXPECT_THAT(Ask("query robot1/pose/state:o"),
              HasSubstr("name /robot1/pose/state:o ip 127.0.0.1 port 40001"));
  EXPECT_THAT(Ask("bot query /robot1/pose/state:o"), HasSubstr("(port_number 40001)"));
  EXPECT_EQ(Ask("query /nope"), kEnd);
  Ask("query /robot1/motors");
  EXPECT_EQ(asked, (std::vector<std::string>{"/robot1/pose/state:o", "/nope"}));
}

TEST_F(NameProtocolTest, ANameThatMayBeOpenedIsNobodyElses) {
  NameHooks hooks;
  hooks.open = [&](const std::string& name, const std::string& /*asker*/) {
    if (name == "/robot1/pose/state:o") table_.AddOwn(name, 40001, nullptr, NameKind::kAlias);
  };
  ASSERT_EQ(table_.Register("/robot1/pose/state:o", "tcp", "127.0.0.1", 5, {"127.0.0.1"}).refused, "");
  context_.hooks = &hooks;
  EXPECT_THAT(Ask("query /robot1/pose/state:o"), HasSubstr("port 40001"));
  table_.RemoveOwn("/robot1/pose/state:o");
  EXPECT_THAT(Ask("register /robot1/pose/state:o tcp 127.0.0.1 5"), HasSubstr("is a name of the daemon"));
}

TEST_F(NameProtocolTest, WhoeverIsAskedForIsInUse) {
  context_.now = 7;
  Ask("query /robot1/motors");
  EXPECT_EQ(table_.Find("/robot1/motors")->used, 7);
  context_.now = 8;
  Ask("bot query /robot1/motors");
  EXPECT_EQ(table_.Find("/robot1/motors")->used, 8);
}

TEST_F(NameProtocolTest, AnUnknownNameGetsTheEndLineAlone) {
  EXPECT_EQ(Ask("NAME_SERVER query /nope"), kEnd);
  EXPECT_EQ(Ask("NAME_SERVER query tcp://robot1/motors"), kEnd);
  EXPECT_EQ(Ask("NAME_SERVER frobnicate"), kEnd);
  EXPECT_EQ(Ask("NAME_SERVER"), kEnd);
}

TEST_F(NameProtocolTest, AnswersCarryTheAddressAtWhichItWasAskedOrTheAdvertisedOne) {
  context_.asked_at = "192.0.2.7";
  EXPECT_THAT(Ask("query /robot1/motors"), HasSubstr(" ip 192.0.2.7 port"));
  context_.advertise = "198.51.100.1";
  EXPECT_THAT(Ask("query /robot1/motors"), HasSubstr(" ip 198.51.100.1 port"));
  Ask("register /ext tcp 10.0.0.9 17001");
  EXPECT_THAT(Ask("query /ext"), HasSubstr(" ip 10.0.0.9 port 17001"));
}

TEST_F(NameProtocolTest, ListsByNameAndByPrefix) {
  Ask("NAME_SERVER register /sim/rpc:i tcp 127.0.0.1 17001");
  EXPECT_EQ(Ask("NAME_SERVER list"),
            std::string("registration name /robot1/distance ip 127.0.0.1 port 10003 type tcp\r\n"
                        "registration name /robot1/motors ip 127.0.0.1 port 10002 type tcp\r\n"
                        "registration name /sim/rpc:i ip 127.0.0.1 port 17001 type tcp\r\n") +
                kEnd);
  EXPECT_EQ(Ask("NAME_SERVER list /sim"),
            std::string("registration name /sim/rpc:i ip 127.0.0.1 port 17001 type tcp\r\n") + kEnd);
}

TEST_F(NameProtocolTest, RegistersOtherPrograms) {
  EXPECT_EQ(Ask("NAME_SERVER register /sim/rpc:i tcp 127.0.0.1 17001"),
            std::string("registration name /sim/rpc:i ip 127.0.0.1 port 17001 type tcp\r\n") + kEnd);
  EXPECT_EQ(Ask("NAME_SERVER register /sim/auto"),
            std::string("registration name /sim/auto ip 127.0.0.1 port 11005 type tcp\r\n") + kEnd);
  EXPECT_EQ(Ask("NAME_SERVER register /sim/auto2 tcp 127.0.0.1 ..."),
            std::string("registration name /sim/auto2 ip 127.0.0.1 port 11006 type tcp\r\n") + kEnd);
  EXPECT_EQ(Ask("NAME_SERVER register /sim/typed ... ... -1 yarp/vector"),
            std::string("registration name /sim/typed ip 127.0.0.1 port 11007 type tcp\r\n") + kEnd);
  EXPECT_EQ(Ask("NAME_SERVER register ..."),
            std::string("registration name /tmp/port/1 ip 127.0.0.1 port 11008 type tcp\r\n") + kEnd);
  EXPECT_EQ(Ask("NAME_SERVER unregister /sim/rpc:i"), kEnd);
  EXPECT_EQ(Ask("NAME_SERVER query /sim/rpc:i"), kEnd);
  EXPECT_EQ(Ask("NAME_SERVER unregister /sim/rpc:i"), kEnd);
}

TEST_F(NameProtocolTest, RefusesALiveNameAndTheDaemonsOwn) {
  Ask("register /ext tcp 10.0.0.9 17001");
  for (const char* line : {"register /ext tcp 10.0.0.8 17001", "register /robot1/motors tcp 127.0.0.1 17001",
                           "NAME_SERVER unregister /robot1/motors", "register /simulation",
                           "set /robot1/motors offers tcp", "register noslash tcp 127.0.0.1 1",
                           "register /x tcp 127.0.0.1 99999", "register /x tcp 127.0.0.1 abc"}) {
    const std::string answer = Ask(line);
    EXPECT_THAT(answer, StartsWith("*** refused: ")) << line;
    EXPECT_TRUE(answer.ends_with(kEnd)) << line;
  }
  EXPECT_THAT(Ask("query /robot1/motors"), HasSubstr("port 10002"));
  EXPECT_EQ(Ask("register /ext tcp 10.0.0.9 17001").substr(0, 12), "registration");  // the same again
}

TEST_F(NameProtocolTest, KeepsPropertiesOfOtherPrograms) {
  Ask("register /sim/rpc:i tcp 127.0.0.1 17001");
  EXPECT_EQ(Ask("NAME_SERVER set /sim/rpc:i accepts tcp text"),
            std::string("port /sim/rpc:i property accepts = tcp text\r\n") + kEnd);
  EXPECT_EQ(Ask("NAME_SERVER get /sim/rpc:i accepts"),
            std::string("port /sim/rpc:i property accepts = tcp text\r\n") + kEnd);
  EXPECT_EQ(Ask("NAME_SERVER check /sim/rpc:i accepts text"),
            std::string("port /sim/rpc:i property accepts value text present true\r\n") + kEnd);
  EXPECT_EQ(Ask("NAME_SERVER check /sim/rpc:i accepts tex"),
            std::string("port /sim/rpc:i property accepts value tex present false\r\n") + kEnd);
  EXPECT_EQ(Ask("NAME_SERVER set /nope foo bar"), kEnd);
}

TEST_F(NameProtocolTest, RoutesAnnouncesAndAnswersTheBotForm) {
  Ask("register /sim/rpc:i tcp 127.0.0.1 17001");
  EXPECT_EQ(Ask("NAME_SERVER route /sim/rpc:i /robot1/motors"),
            std::string("port /sim/rpc:i route /robot1/motors = tcp://robot1/motors\r\n") + kEnd);
  EXPECT_EQ(Ask("NAME_SERVER announce /sim/rpc:i"), "[ok]\r\n");
  EXPECT_EQ(Ask("NAME_SERVER bot query /sim/rpc:i"),
            "port (name \"/sim/rpc:i\") (ip \"127.0.0.1\") (port_number 17001) (carrier tcp)\r\n");
  EXPECT_EQ(Ask("NAME_SERVER bot query /nope"), "port (error -2 \"port not known\")\r\n");
  EXPECT_EQ(Ask("NAME_SERVER bot list /sim"),
            "ports (port (name \"/sim/rpc:i\") (ip \"127.0.0.1\") (port_number 17001) (carrier tcp))\r\n");
}

TEST_F(NameProtocolTest, OpenFindsAModuleOrSaysWhatWasMeant) {
  const NameReply reply = AnswerNameLine("OPEN /robot1/motors", context_, table_);
  EXPECT_EQ(reply.text, "ok\n");
  EXPECT_TRUE(reply.open);
  EXPECT_EQ(Ask("OPEN /robot1/moters"),
            "error 10 no such name /robot1/moters; did you mean /robot1/motors?\n");
  EXPECT_EQ(Ask("OPEN /robot1"), "error 10 no such name /robot1; did you mean /robot1/motors?\n");
  EXPECT_EQ(Ask("OPEN /kitchen"), "error 10 no such name /kitchen; list shows all\n");
  Ask("register /ext tcp 10.0.0.9 17001");
  EXPECT_EQ(Ask("OPEN /ext"), "error 10 /ext is another program's: connect to 10.0.0.9 port 17001\n");
  EXPECT_FALSE(AnswerNameLine("OPEN /ext", context_, table_).open);
}

TEST_F(NameProtocolTest, OpenIsTakenInSmallLettersToo) {
  EXPECT_TRUE(AnswerNameLine("open /robot1/motors", context_, table_).open);
}

TEST_F(NameProtocolTest, AFarewellInAnyCaseClosesTheConnection) {
  for (const char* word : {"exit", "quit", "bye", "QUIT", "Bye"}) {
    EXPECT_TRUE(AnswerNameLine(word, context_, table_).close) << word;
  }
  EXPECT_FALSE(AnswerNameLine("QUITE", context_, table_).close);
}

TEST_F(NameProtocolTest, OpenAloneSaysWhatToWrite) {
  EXPECT_EQ(Ask("OPEN /robot1/motors extra"), "error 4 OPEN takes one name, not extra as well\n");
  EXPECT_EQ(Ask("OPEN"), "error 10 OPEN takes a name, as in OPEN /robot1/distance; list shows all\n");
}

TEST_F(NameProtocolTest, WhatAPeerSentComesBackWithoutControlCharacters) {
  Ask("register /ext tcp 10.0.0.9 17001");
  EXPECT_EQ(Ask("set /ext ti\033tle \033[2Jred"),
            std::string("port /ext property ti?tle = ?[2Jred\r\n") + kEnd);
  EXPECT_EQ(Ask("check /ext title \033[2J"),
            std::string("port /ext property title value ?[2J present false\r\n") + kEnd);
}

TEST_F(NameProtocolTest, HttpIsRefusedAndAnUnknownWordExplained) {
  const NameReply http = AnswerNameLine("GET /list HTTP/1.1", context_, table_);
  EXPECT_THAT(http.text, StartsWith("HTTP/1.1 400 "));
  EXPECT_TRUE(http.close);
  EXPECT_THAT(Ask("hello"), StartsWith("*** refused: \"hello\""));
  EXPECT_THAT(Ask("help"), HasSubstr("OPEN $name"));
  EXPECT_EQ(Ask(""), "");
}

TEST_F(NameProtocolTest, HostileLinesNeverChangeOwnNames) {
  for (const char* line : {"register", "set", "get", "check", "route", "bot", "OPEN", "unregister", "query",
                           "register \"\" \"\" \"\" \"\"",
                           "register /a\x01"
                           "b",
                           "set /robot1/motors", "\"", "\" \""}) {
    Ask(line);
  }
  EXPECT_EQ(table_.List("/robot1").size(), 2U);
  EXPECT_THAT(Ask("query /robot1/motors"), HasSubstr("port 10002"));
}

TEST_F(NameProtocolTest, ReadOnlyRefusesWhatChangesNamesAndSaysWhy) {
  context_.read_only = true;
  for (const char* line : {"register /mine", "unregister /ext", "set /ext title red"}) {
    EXPECT_THAT(Ask(line), HasSubstr("*** refused: the daemon was started with --read-only")) << line;
  }
  EXPECT_THAT(Ask("query /robot1/motors"), HasSubstr("port 10002"));
}

}  // namespace
}  // namespace coopdyn
