// SPDX-License-Identifier: MIT
#include "server/naming/name_talk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace coopdyn {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

class NameTalkTest : public ::testing::Test {
 protected:
  NameTalkTest() {
    hooks_.open = [](const std::string&, const std::string&) {};
    hooks_.connect = [this](const Subscription& each, bool connects) {
      told_.push_back((connects ? "+" : "-") + each.from + " " + each.to);
    };
    context_.hooks = &hooks_;
  }
  std::string Ask(NameTalk& talk, const std::string& command, const std::string& request) {
    EXPECT_EQ(talk.Answer(command + "\r", context_, table_).text, "");
    return talk.Answer(request + "\r", context_, table_).text;
  }
  std::string Line(const std::string& line) { return AnswerNameLine(line, context_, table_).text; }

  NameTable table_;
  std::vector<std::string> told_;
  NameHooks hooks_;
  NameContext context_{"127.0.0.1", "127.0.0.1", ""};
};

TEST_F(NameTalkTest, BeginsAsAConnectionByText) {
  EXPECT_FALSE(NameTalk::Begin("NAME_SERVER list"));
  EXPECT_FALSE(NameTalk::Begin("CONNECT example.org:443 HTTP/1.1\r"));
  EXPECT_EQ(NameTalk::Begin("CONNACK admin\r")->Welcome(), "Welcome admin\r\n");
  EXPECT_EQ(NameTalk::Begin("CONNECT /me\r")->Welcome(), "Welcome /me\r\n");
}

TEST_F(NameTalkTest, AnswersRequestsWithoutTheEndLine) {
  NameTalk talk = *NameTalk::Begin("CONNACK admin");
  EXPECT_EQ(Ask(talk, "d", "register /a tcp 127.0.0.1 17001"),
            "registration name /a ip 127.0.0.1 port 17001 type tcp\r\n<ACK>\r\n");
  EXPECT_EQ(Ask(talk, "d", "query /b"), "\r\n<ACK>\r\n");
  EXPECT_EQ(Ask(talk, "D", "query /a"), "<ACK>\r\n");
  EXPECT_EQ(Ask(talk, "a", "[ver]"), "[ver] 1 2 3\r\n<ACK>\r\n");
  EXPECT_THAT(Ask(talk, "a", "[pid]"), StartsWith("[fail] "));
  EXPECT_THAT(talk.Answer("*", context_, table_).text, StartsWith("This is the name server"));
  EXPECT_THAT(talk.Answer("nonsense", context_, table_).text, StartsWith("Port command not understood."));
  EXPECT_TRUE(talk.Answer("q", context_, table_).close);
}

TEST_F(NameTalkTest, WithoutAcknowledgementsThereAreNone) {
  NameTalk talk = *NameTalk::Begin("CONNECT admin");
  EXPECT_EQ(Ask(talk, "d", "announce /a"), "[ok]\r\n");
  EXPECT_EQ(Ask(talk, "D", "announce /a"), "");
}

TEST_F(NameTalkTest, NoModuleCanBeOpenedFromHere) {
  table_.AddOwn("/robot1/motors", 10002, nullptr);
  NameTalk talk = *NameTalk::Begin("CONNECT admin");
  talk.Answer("d", context_, table_);
  EXPECT_FALSE(talk.Answer("OPEN /robot1/motors", context_, table_).open);
}

TEST_F(NameTalkTest, SubscriptionsAreToldAtOnceAndAtEachAnnouncement) {
  EXPECT_EQ(Line("NAME_SERVER subscribe \"tcp://clock\" \"tcp://me/clock:i\""), "[ok]\r\n");
  EXPECT_THAT(told_, ElementsAre("+/clock /me/clock:i"));
  Line("NAME_SERVER announce /other");
  Line("NAME_SERVER announce /me/clock:i");
  Line("NAME_SERVER announce /clock");
  EXPECT_EQ(told_.size(), 3u);
  EXPECT_THAT(Line("NAME_SERVER subscribe"),
              StartsWith("subscriptions (subscription (src \"/clock\") (dest \"/me/clock:i\"))\r\n"));
  Line("NAME_SERVER unsubscribe /clock /me/clock:i");
  EXPECT_EQ(told_.back(), "-/clock /me/clock:i");
  Line("NAME_SERVER announce /clock");
  EXPECT_EQ(told_.size(), 4u);
  EXPECT_THAT(Line("NAME_SERVER subscribe"), StartsWith("subscriptions\r\n"));
}

TEST_F(NameTalkTest, SubscriptionsThatCannotBeAreRefused) {
  EXPECT_THAT(Line("NAME_SERVER subscribe /clock"), StartsWith("*** refused: write two ports, as in "));
  for (std::size_t i = 0; i < NameTable::kMaxSubscriptions; ++i)
    EXPECT_EQ(Line("NAME_SERVER subscribe /clock /" + std::to_string(i)), "[ok]\r\n");
  EXPECT_THAT(Line("NAME_SERVER subscribe /clock /one_more"), StartsWith("*** refused: there are too many"));
  EXPECT_EQ(Line("NAME_SERVER subscribe /clock /7"), "[ok]\r\n");
}

}  // namespace
}  // namespace coopdyn
