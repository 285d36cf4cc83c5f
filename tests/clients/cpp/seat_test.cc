// SPDX-License-Identifier: MIT
// A seat of a class in the C++ client, and a unix socket at a path, against the scripted daemon. It answers
// the line with the seat only after the next line has arrived.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "tests/clients/cpp/error_of.h"
#include "tests/clients/cpp/server_process.h"

namespace coopdyn::client {
namespace {

/// An environment variable during the object's lifetime.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

class SeatTest : public testing::Test {
 protected:
  SeatTest() { std::filesystem::create_directories(folder_); }
  ~SeatTest() override { std::filesystem::remove_all(folder_); }

  std::string Content(const std::string& file) const {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  const std::string folder_ = testing::TempDir() + "seat_test" + std::to_string(getpid());
  const Options ana_{.seat = "ana", .pin = "0912"};
};

TEST_F(SeatTest, EveryConnectionTakesTheSeat) {
  const auto daemon = ServerProcess::Fake({"--seat", "ana:0912", "--robots", "2"});
  auto sim = connect(daemon.server(), ana_);
  auto robot = sim.robot(1);
  robot.set_velocity(0.1, 0);
  sim.step();
  robot.sense();
  sim.team("robot2").step(std::vector{0.1, 0.0});
  EXPECT_FALSE(sim.modules().empty());
  EXPECT_TRUE(doctor(daemon.server(), ana_));
}

TEST_F(SeatTest, AVariableTakesItAndArgumentsWin) {
  const auto daemon = ServerProcess::Fake({"--seat", "ana:0912"});
  {
    const Variable seat("COOPDYN_SEAT", "ana:0912");
    EXPECT_EQ(connect(daemon.server()).robots().size(), 1U);
  }
  const Variable seat("COOPDYN_SEAT", "ben:7305");
  EXPECT_EQ(connect(daemon.server(), ana_).robots().size(), 1U);
  const auto ordinary = ServerProcess::Fake({});
  EXPECT_EQ(connect(ordinary.server(), {.seat = ""}).robots().size(), 1U);
}

TEST_F(SeatTest, FilesComeFromThePageOfTheSeat) {
  const auto daemon = ServerProcess::Fake({"--seat", "ana:0912"});
  auto sim = connect(daemon.server(), ana_);
  const std::string file = folder_ + "/a.run";
  sim.fetch_run("lesson", file);
  EXPECT_EQ(Content(file), "/s/ana/runs/lesson.run");
  sim.snapshot(file);
  EXPECT_TRUE(Content(file).starts_with("/s/ana/snapshot.png?")) << Content(file);
}

TEST_F(SeatTest, RefusalsAreTheWordsOfTheClass) {
  const auto daemon = ServerProcess::Fake({"--seat", "ana:0912"});
  const Error wrong = ErrorOf([&] { connect(daemon.server(), {.seat = "ana", .pin = "0913"}); });
  EXPECT_TRUE(Says(wrong, "12 no seat with this PIN")) << wrong.text();
  const Error none = ErrorOf([&] { connect(daemon.server()); });
  EXPECT_TRUE(Says(none, "12 this is a class")) << none.text();
  const auto ordinary = ServerProcess::Fake({});
  const Error error = ErrorOf([&] { connect(ordinary.server(), ana_); });
  EXPECT_TRUE(Says(error, "5 " + ordinary.server() + " is not a class: leave seat and pin out"))
      << error.text();
}

TEST_F(SeatTest, WhatNoSheetHasSaysWhatToWrite) {
  const std::string how = R"(write connect("labserver", {.seat = "ana", .pin = "7305"}))";
  for (const Options& options :
       {Options{.seat = "ana"}, Options{.pin = "0912"}, Options{.seat = "Ana", .pin = "0912"},
        Options{.seat = "-ana", .pin = "0912"}, Options{.seat = "ana", .pin = "091"},
        Options{.seat = "ana", .pin = "0912\n"}}) {
    const Error error = ErrorOf([&] { connect("", options); });
    EXPECT_EQ(error.code(), 3);
    EXPECT_TRUE(Says(error, how)) << error.text();
  }
  for (const char* const half : {"ana", "ana:", ":0912"}) {
    const Variable seat("COOPDYN_SEAT", half);
    const Error error = ErrorOf([] { connect(); });
    EXPECT_TRUE(Says(error, "needs its")) << error.text();
  }
}

TEST_F(SeatTest, ADaemonIsReachedByTheUnixSocketAtAPath) {
  const std::string path = "/tmp/seat_test" + std::to_string(getpid()) + ".sock";
  {
    const auto daemon = ServerProcess::Fake({"--path", path});
    const Variable server("COOPDYN_SERVER", "unix:" + path);
    auto sim = connect();
    auto robot = sim.robot(1);
    robot.set_velocity(0.1, 0);
    sim.step();
    EXPECT_FALSE(sim.modules().empty());
    EXPECT_TRUE(doctor());
  }
  std::filesystem::remove(path);
  for (const std::string& wrong : {"unix:" + path, "unix:/" + std::string(200, 'a')}) {
    const Error error = ErrorOf([&] { connect(wrong); });
    EXPECT_TRUE(Says(error, "-1 nothing can be reached at " + wrong)) << error.text();
  }
  const Error relative = ErrorOf([] { connect("unix:door"); });
  EXPECT_TRUE(Says(relative, "for a unix socket unix:/PATH")) << relative.text();
}

}  // namespace
}  // namespace coopdyn::client
