// SPDX-License-Identifier: MIT
// Wrong arguments of the C++ client: errors that say what to write.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "tests/clients/cpp/error_of.h"
#include "tests/clients/cpp/server_process.h"

namespace coopdyn::client {
namespace {

TEST(Arguments, TheAddressOfThePageIsToldAsSuch) {
  for (const std::string page : {"http://127.0.0.1:21080/", "https://labserver"}) {
    const Error error = ErrorOf([&] { connect(page); });
    EXPECT_TRUE(Says(error, "4 " + page + " is the address of the page")) << error.text();
    EXPECT_TRUE(Says(error, "write e.g. connect(\"127.0.0.1:10000\")")) << error.text();
  }
}

TEST(Arguments, WhatTheDaemonWouldRefuseIsToldInWordsOfTheClient) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep"});
  auto sim = connect(daemon.server());
  auto r = sim.robot(1);
  const std::vector<std::pair<std::function<void()>, std::string>> cases = {
      {[&] { sim.load_scenario(""); }, "3 no scenario: write sim.load_scenario(\"corridor\")"},
      {[&] { sim.set_step(5); }, "4 a step lasts 0.0005 to 0.1 s, not 5: write sim.set_step(0.01)"},
      {[&] { sim.set_step(0.0012346); }, "not 0.0012346 s: write sim.set_step(0.001235)"},
      {[&] { sim.reset(-1); }, "4 a seed is at least 0, not -1: write sim.reset(7)"},
      {[&] { sim.step(0); }, "4 n must be at least 1, not 0"},
      {[&] { sim.step(20'000'000); }, "4 n must be at most 10000000, not 20000000: write sim.step("},
      {[&] { sim.note(""); }, "3 no note: write sim.note(\"half-time\")"},
      {[&] { sim.save_state("1st"); }, "at most 63: write sim.save_state(\"before_turn\")"},
      {[&] { sim.play(65); }, "below 0 backwards, not 65: write sim.play(2)"},
      {[&] { sim.set_play_speed(0); }, "not 0: write sim.play(2), or sim.pause()"},
      {[&] { sim.skip(0); }, "not 0: write sim.skip(1)"},
      {[&] { r.get_target(""); }, "3 a target is a colour or an id: write r.get_target(\"red\")"}};
  for (const auto& [call, says] : cases) {
    const Error error = ErrorOf(call);
    EXPECT_TRUE(Says(error, says)) << error.text();
  }
}

TEST(Arguments, StepsAtTheLimitsAreSent) {
  const auto daemon = ServerProcess::Fake({"--mode", "lockstep"});
  auto sim = connect(daemon.server());
  for (const double step_s : {0.0005, 0.000501, 0.033333, 0.1}) {
    sim.set_step(step_s);
    EXPECT_EQ(sim.dt(), step_s);
  }
}

}  // namespace
}  // namespace coopdyn::client
