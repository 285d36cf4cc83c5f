// SPDX-License-Identifier: MIT
// GET /api/costs for measured times; the tests control the clock.
#include "server/web/costs.h"

#include <gtest/gtest.h>

#include <boost/json.hpp>

namespace coopdyn {
namespace {

namespace json = boost::json;
constexpr Nanoseconds kMs = 1'000'000;
constexpr Nanoseconds kSecond = kNanosecondsPerSecond;

class CostBookTest : public testing::Test {
 protected:
  /// Adds `steps`, each with `physics`, and `waited` for robot3.
  void Steps(std::uint64_t steps, Nanoseconds physics, Nanoseconds waited) {
    const auto count = static_cast<Nanoseconds>(steps);
    now_.costs.steps += steps;
    now_.costs.times.physics += count * physics;
    now_.costs.busy += count * (physics + kMs);
    now_.costs.idle += count * waited;
    now_.waits.total += count * waited;
    now_.waits.robots.resize(1);
    now_.waits.robots[0].robot = "robot3";
    now_.waits.robots[0].client = "ana";
    now_.waits.robots[0].waited += count * waited;
    now_.waits.robots[0].alone += count * waited / 2;
  }
  json::value Ask(Nanoseconds later) {
    now_.now += later;
    return json::parse(book_.Json(now_));
  }
  static json::object Part(const json::value& costs, std::string_view name) {
    for (const json::value& part : costs.at("parts").as_array()) {
      if (part.at("part").as_string() == name) return part.as_object();
    }
    ADD_FAILURE() << "no part " << name;
    return {};
  }

  CostSnapshot now_{.now = 100 * kSecond, .mode = Mode::kLockstep};
  CostBook book_;
};

TEST_F(CostBookTest, MillisecondsPerStepSinceTheResetAndOverTheLastSecond) {
  Steps(100, 2 * kMs, 4 * kMs);
  EXPECT_TRUE(Part(Ask(0), "physics").at("last_ms").is_null());
  Steps(100, 3 * kMs, 4 * kMs);
  const json::value costs = Ask(kSecond);
  EXPECT_DOUBLE_EQ(Part(costs, "physics").at("all_ms").to_number<double>(), 2.5);
  EXPECT_DOUBLE_EQ(Part(costs, "physics").at("last_ms").to_number<double>(), 3);
  EXPECT_EQ(costs.at("steps").to_number<int>(), 200);
  EXPECT_EQ(costs.at("steps_last").to_number<int>(), 100);
}

TEST_F(CostBookTest, WhatIsInNoPartIsTheRest) {
  Steps(10, 2 * kMs, 0);
  EXPECT_DOUBLE_EQ(Part(Ask(0), "rest").at("all_ms").to_number<double>(), 1);
}

TEST_F(CostBookTest, TimeBetweenStepsIsForClientsOrForThePace) {
  Steps(10, 2 * kMs, 4 * kMs);
  now_.costs.idle += 10 * kMs;
  const json::value costs = Ask(0);
  EXPECT_DOUBLE_EQ(Part(costs, "clients").at("all_ms").to_number<double>(), 4);
  EXPECT_DOUBLE_EQ(Part(costs, "pace").at("all_ms").to_number<double>(), 1);
}

TEST_F(CostBookTest, AClientHasTheTimeThatTheWorldWaitsForIt) {
  Steps(10, 2 * kMs, 4 * kMs);
  Ask(0);
  Steps(10, 2 * kMs, 8 * kMs);
  const json::value costs = Ask(kSecond);
  const json::object& client = costs.at("clients").at(0).as_object();
  EXPECT_EQ(client.at("name").as_string(), "robot3");
  EXPECT_EQ(client.at("client").as_string(), "ana");
  EXPECT_DOUBLE_EQ(client.at("last_ms").to_number<double>(), 8);
  EXPECT_DOUBLE_EQ(client.at("all_ms").to_number<double>(), 6);
  EXPECT_DOUBLE_EQ(client.at("alone_last_ms").to_number<double>(), 4);
}

TEST_F(CostBookTest, TheRobotsOfATeamAreOneClient) {
  now_.costs.steps = 10;
  now_.waits.robots = {{"a_1", "ana", true, 30 * kMs, 0}, {"a_2", "ana", true, 50 * kMs, 50 * kMs}};
  const json::value costs = Ask(0);
  ASSERT_EQ(costs.at("clients").as_array().size(), 1u);
  EXPECT_EQ(costs.at("clients").at(0).at("robots").to_number<int>(), 2);
  EXPECT_DOUBLE_EQ(costs.at("clients").at(0).at("all_ms").to_number<double>(), 5);
}

TEST_F(CostBookTest, AResetForgetsTheSecondBefore) {
  Steps(100, 2 * kMs, 0);
  Ask(0);
  now_.costs = {.runs = 1};
  Steps(10, 2 * kMs, 0);
  const json::value costs = Ask(kSecond);
  EXPECT_TRUE(costs.at("steps_last").is_null());
  EXPECT_DOUBLE_EQ(Part(costs, "physics").at("all_ms").to_number<double>(), 2);
}

TEST_F(CostBookTest, WithoutStepsNothingHasACost) {
  EXPECT_TRUE(Part(Ask(0), "physics").at("all_ms").is_null());
}

TEST_F(CostBookTest, ThreadsOfOneNameCountTogether) {
  now_.threads = {{"robot1", 1, 0}, {"render", 2, 0}, {"pool", 3, 0}, {"pool", 4, 0}};
  Ask(0);
  Steps(100, kMs, 0);
  now_.threads = {{"robot1", 1, 0}, {"render", 2, 50 * kMs}, {"pool", 3, 100 * kMs}, {"pool", 4, 100 * kMs}};
  const json::value costs = Ask(kSecond);
  for (const json::value& thread : costs.at("threads").as_array()) {
    if (thread.at("name").as_string() != "pool") continue;
    EXPECT_EQ(thread.at("count").to_number<int>(), 2);
    EXPECT_DOUBLE_EQ(thread.at("last_ms").to_number<double>(), 2);
    EXPECT_DOUBLE_EQ(thread.at("cores").to_number<double>(), 0.2);
    return;
  }
  FAIL() << "no thread called pool";
}

}  // namespace
}  // namespace coopdyn
