// SPDX-License-Identifier: MIT
// Recordings over HTTP.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "server/base/mutex.h"
#include "tests/server/base/temp_folder.h"
#include "web_fixture.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// Provides recordings, and answers on a separate thread.
class FakeRuns {
 public:
  std::string Write(const std::string& name, const std::string& bytes) { return folder_.Write(name, bytes); }
  WebOptions Options(WebRunFile answer) {
    WebOptions options = WebWorld::DefaultOptions();
    options.runs.list = [this](auto done) { Run([done] { done(R"([{"name":"lesson1.run"}])"); }); };
    options.runs.open = [this, answer](const std::string& name, auto done) {
      Run([this, name, answer, done] {
        {
          const MutexLock lock(mutex_);
          asked_.push_back(name);
        }
        done(answer);
      });
    };
    return options;
  }
  std::vector<std::string> asked() {
    const MutexLock lock(mutex_);
    return asked_;
  }

 private:
  void Run(std::function<void()> work) { threads_.emplace_back(std::move(work)); }

  const TempFolder folder_;
  Mutex mutex_;
  std::vector<std::string> asked_ GUARDED_BY(mutex_);
  std::vector<std::jthread> threads_;  // added by the UI thread; joined before the data they use is destroyed
};

/// Larger than a socket buffer.
std::string ManyBytes() {
  std::string bytes(5'000'000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7 + i / 251);
  return bytes;
}

TEST(WebRuns, AreListed) {
  FakeRuns runs;
  const WebWorld world(runs.Options({}));
  const HttpReply reply = Fetch(world.port, "GET", "/runs");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.body, "[{\"name\":\"lesson1.run\"}]\n");
  EXPECT_THAT(reply.header, HasSubstr("application/json"));
}

TEST(WebRuns, AreCopiedWhole) {
  FakeRuns runs;
  const std::string bytes = ManyBytes();
  const std::string file = runs.Write("lesson1.run", bytes);
  const WebWorld world(runs.Options({200, {}, file, false}));
  const HttpReply reply = Fetch(world.port, "GET", "/runs/lesson1.run");
  EXPECT_EQ(reply.status, 200);
  EXPECT_TRUE(reply.body == bytes) << reply.body.size();
  EXPECT_THAT(reply.header, HasSubstr("Content-Length: 5000000\r\n"));
  EXPECT_THAT(reply.header, HasSubstr("filename=\"lesson1.run\""));
  EXPECT_THAT(reply.header, HasSubstr("X-Content-Type-Options: nosniff"));
  EXPECT_EQ(runs.asked(), std::vector<std::string>{"lesson1.run"});
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST(WebRuns, NamesOfAnyLettersAreDecoded) {
  FakeRuns runs;
  const WebWorld world(runs.Options({200, {}, runs.Write("a.run", "12345"), false}));
  const HttpReply reply = Fetch(world.port, "GET", "/runs/my%20lesson+%C3%BC%22.run");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(runs.asked(), std::vector<std::string>{"my lesson+ü\".run"});
  EXPECT_THAT(reply.header, HasSubstr("attachment; filename*=UTF-8''my%20lesson%2B%C3%BC%22.run\r\n"));
}

TEST(WebRuns, HeadTellsTheLengthOnly) {
  FakeRuns runs;
  const WebWorld world(runs.Options({200, {}, runs.Write("a.run", "12345"), false}));
  const HttpReply reply = Fetch(world.port, "HEAD", "/runs/a.run");
  EXPECT_THAT(reply.header, HasSubstr("Content-Length: 5\r\n"));
  EXPECT_EQ(reply.body, "");
}

TEST(WebRuns, AnExportIsRemovedOnceItIsSent) {
  FakeRuns runs;
  const std::string file = runs.Write("made.mat", "numbers");
  const WebWorld world(runs.Options({200, {}, file, true}));
  EXPECT_EQ(Fetch(world.port, "GET", "/runs/lesson1.mat").body, "numbers");
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(WebRuns, WhatCannotBeCopiedSaysWhy) {
  FakeRuns runs;
  {
    const WebWorld world(runs.Options({409, "stop the recording first", {}, false}));
    const HttpReply reply = Fetch(world.port, "GET", "/runs/lesson1.run");
    EXPECT_EQ(reply.status, 409);
    EXPECT_EQ(reply.body, "stop the recording first\n");
  }
  const WebWorld gone(runs.Options({200, {}, "/nowhere/lesson1.run", false}));
  EXPECT_EQ(Fetch(gone.port, "GET", "/runs/lesson1.run").status, 404);
  EXPECT_EQ(Fetch(gone.port, "POST", "/runs/lesson1.run").status, 405);
}

TEST(WebRuns, OtherPathsNeverReachWhoeverKeepsThem) {
  FakeRuns runs;
  const WebWorld world(runs.Options({}));
  for (const char* target :
       {"/runs/", "/runs/../lesson1.run", "/runs/%2e%2e/lesson1.run", "/runs/%2e%2e%2flesson1.run",
        "/runs/..%2Flesson1.mat", "/runs/%2ftmp%2flesson1.run", "/runs/a/b.run", "/runs/.run",
        "/runs/.hidden.run", "/runs/%2ehidden.run", "/runs/-x.run", "/runs/a%00.run", "/runs/a.run%00",
        "/runs/a%0d%0aX-Y:%20z.run", "/runs/%ff.run", "/runs/%zz.run", "/runs/a.run%2", "/runs/passwd"}) {
    EXPECT_EQ(Fetch(world.port, "GET", target).status, 404) << target;
  }
  EXPECT_TRUE(runs.asked().empty());
}

TEST(WebRuns, WithoutAFolderThereAreNone) {
  const WebWorld world;
  EXPECT_EQ(Fetch(world.port, "GET", "/runs").body, "[]\n");
  EXPECT_EQ(Fetch(world.port, "GET", "/runs/lesson1.run").status, 404);
}

TEST(WebRuns, AClientThatGoesAwayAndAServerThatStopsLeaveNothing) {
  FakeRuns runs;
  const std::string file = runs.Write("lesson1.run", ManyBytes());
  auto world = std::make_unique<WebWorld>(runs.Options({200, {}, file, false}));
  const std::string request = "GET /runs/lesson1.run HTTP/1.1\r\nHost: localhost\r\n\r\n";
  {
    RawClient gone(world->port);
    gone.Send(request);
    EXPECT_THAT(gone.ReadUntil("\r\n\r\n"), StartsWith("HTTP/1.1 200"));
  }
  RawClient slow(world->port);
  slow.Send(request);
  EXPECT_THAT(slow.ReadUntil("\r\n\r\n"), StartsWith("HTTP/1.1 200"));
  world->web->Stop();
  EXPECT_LT(slow.ReadAll().size(), 5'000'000u);
}

}  // namespace
}  // namespace coopdyn
