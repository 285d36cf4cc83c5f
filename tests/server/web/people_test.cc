// SPDX-License-Identifier: MIT
#include "server/web/people.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "server/web/page_message.h"

namespace coopdyn {
namespace {

struct Viewer final : PeopleWatcher {
  void OnPeople(const std::shared_ptr<const std::string>& people) override { heard.push_back(*people); }
  std::vector<std::string> heard;
};

TEST(People, EachIsToldWhoIsThereAndWhatTheySelected) {
  People people;
  const auto ana = std::make_shared<Viewer>(), ben = std::make_shared<Viewer>();
  const std::uint64_t first = people.Enter(ana), second = people.Enter(ben);
  people.Set(first, {"Ana", "BOX_1"});
  EXPECT_EQ(
      ben->heard.back(),
      R"({"type":"people","people":[{"id":1,"name":"Ana","selected":"BOX_1"},{"id":2,"name":"","selected":""}]})");
  people.Leave(first);
  EXPECT_EQ(ben->heard.back(), R"({"type":"people","people":[{"id":2,"name":"","selected":""}]})");
  EXPECT_EQ(ana->heard.size(), 1u);
  people.Set(second, {"Ben", ""});
  EXPECT_EQ(ben->heard.size(), 3u);
}

TEST(People, OneWhoHasGoneWithoutAWordIsForgotten) {
  People people;
  auto ana = std::make_shared<Viewer>();
  const auto ben = std::make_shared<Viewer>();
  people.Enter(ana);
  const std::uint64_t second = people.Enter(ben);
  ana.reset();
  people.Set(second, {});
  EXPECT_EQ(ben->heard.back(), R"({"type":"people","people":[{"id":2,"name":"","selected":""}]})");
}

TEST(People, ANameIsEscaped) {
  People people;
  const auto ana = std::make_shared<Viewer>();
  people.Set(people.Enter(ana), {"\"<b>", ""});
  EXPECT_NE(ana->heard.back().find(R"("name":"\"\u003cb\u003e")"), std::string::npos) << ana->heard.back();
}

TEST(PageMessage, OneSaysHisNameAndWhatIsSelected) {
  const PageRead read = ReadPageMessage(R"({"type":"me","name":"Ana","selected":"BOX_1"})");
  ASSERT_TRUE(read.message);
  const auto* me = std::get_if<PageMe>(&*read.message);
  ASSERT_NE(me, nullptr);
  EXPECT_EQ(me->name, "Ana");
  EXPECT_EQ(me->selected, "BOX_1");
}

TEST(PageMessage, ALongNameIsRefused) {
  const PageRead read =
      ReadPageMessage(R"({"type":"me","name":")" + std::string(41, 'x') + R"(","selected":""})");
  EXPECT_FALSE(read.message);
  EXPECT_EQ(read.error, "a name has at most 40 bytes, what is selected 63");
}

}  // namespace
}  // namespace coopdyn
