// SPDX-License-Identifier: MIT
#include "server/robot/robot_host.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "server/net/listener.h"
#include "test_client.h"
#include "tests/server/devices/small_world.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;

/// Pins this thread, and those that it starts, to one core.
class OneCore {
 public:
  OneCore() {
    sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    sched_setaffinity(0, sizeof one, &one);
  }
  ~OneCore() { sched_setaffinity(0, sizeof before_, &before_); }
  OneCore(const OneCore&) = delete;
  OneCore& operator=(const OneCore&) = delete;

 private:
  cpu_set_t before_{};
};

/// Steps a world without pause, on a separate thread.
class Stepping {
 public:
  explicit Stepping(SmallWorld& world)
      : thread_([this, &world](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            if (auto work = Take()) work();
            world.Step();
          }
        }) {}

  /// Runs `work` between two steps and waits for it.
  void Between(const std::function<void()>& work) {
    std::packaged_task<void()> task(work);
    std::future<void> done = task.get_future();
    {
      const MutexLock lock(mutex_);
      work_ = [&task] { task(); };
    }
    done.get();
  }

 private:
  std::function<void()> Take() {
    const MutexLock lock(mutex_);
    return std::exchange(work_, nullptr);
  }

  Mutex mutex_;
  std::function<void()> work_ GUARDED_BY(mutex_);
  std::jthread thread_;
};

class RobotHostTest : public testing::Test {
 protected:
  RobotServices Services() {
    return {world_.board, world_.frames, world_.edits, images_, names_,
            net_,         roster_,       guard_,       clock_,  "1.2.3"};
  }
  RobotHostOptions Options() const { return {true, ListenAddresses("127.0.0.1"), 0, {}, 8}; }
  void Load(std::shared_ptr<const Scenario> scenario) { world_.Load(std::move(scenario), Mode::kLockstep); }
  /// Robots without sockets.
  void LoadSwarm(int robots) {
    auto scenario = std::make_shared<Scenario>(*SmallScenario(robots));
    for (RobotEntry& robot : scenario->robots) robot.sockets = false;
    Load(std::move(scenario));
  }
  std::shared_ptr<const Scene> scene() const { return world_.frames.Latest()->scene; }
  /// A host that has started the robots of the scene.
  std::unique_ptr<RobotHost> Start(const RobotHostOptions& options) {
    auto host = std::make_unique<RobotHost>(Services(), options, ports_);
    const std::string error = host->Apply(scene(), true);
    if (!error.empty()) throw std::runtime_error(error);
    return host;
  }
  /// The number of threads for a number of robots; `threads` as in the options.
  std::size_t ThreadsFor(int robots, bool sockets, std::size_t cores, int threads = 0) {
    auto scenario = std::make_shared<Scenario>(*SmallScenario(robots));
    for (RobotEntry& robot : scenario->robots) robot.sockets = sockets;
    Load(scenario);
    RobotHostOptions options = Options();
    options.cores = cores;
    options.threads = threads;
    return Start(options)->thread_count();
  }
  TestClient Connect(const std::string& module) { return TestClient::Connect(names_.Find(module)->port); }

  SteadyClock clock_;
  ImageBoard images_;
  NameTable names_;
  NetServices net_{NullLogger(), clock_};
  ConnectionRoster roster_;
  TokenGuard guard_{"", false};
  SmallWorld world_{2};
  PortPlan ports_{0};
};

TEST_F(RobotHostTest, BringsUpEveryModuleWithNameAndPort) {
  const auto host = Start(Options());
  std::set<int> ports;
  for (const char* name : {"/robot1/motors", "/robot1/distance", "/robot2/target", "/robot2/pose"}) {
    const auto entry = names_.Find(name);
    ASSERT_TRUE(entry) << name;
    ports.insert(entry->port);
    TestClient client = TestClient::Connect(entry->port);
    EXPECT_TRUE(client.ok());
  }
  EXPECT_EQ(ports.size(), 4u);
  EXPECT_EQ(names_.List().size(), 8u);
  EXPECT_EQ(host->thread_count(), 2u);
}

TEST_F(RobotHostTest, ARobotOfAnotherModelOfItsTypeIsMadeAnew) {
  const auto host = Start(Options());
  TestClient client = Connect("/robot1/motors");
  client.Send("get_limits\n");
  EXPECT_THAT(client.Line(), HasSubstr("10.0 0.1 0.4"));
  auto scenario = std::make_shared<Scenario>(*SmallScenario(2));
  auto model = std::make_shared<RobotModel>(*scenario->robots[0].model);
  model->text = "another";
  std::get<DriveModel>(model->actuators[0].kind).max_wheel_speed_rad_s = 20;
  scenario->robots[0].model = std::move(model);
  Load(std::move(scenario));
  EXPECT_EQ(host->Apply(scene(), false), "");
  EXPECT_THAT(client.Line(), HasSubstr("is not in the new scenario"));
  TestClient again = Connect("/robot1/motors");
  again.Send("get_limits\n");
  EXPECT_THAT(again.Line(), HasSubstr("20.0 0.1 0.4"));
}

TEST_F(RobotHostTest, AnswersOverItsSocketAndRunsAStep) {
  world_.StepInline();
  Load(SmallScenario(1));
  const auto host = Start(Options());
  TestClient client = Connect("/robot1/motors");
  client.Send("set_velocity 0.2 0\nget_wheels\n");
  EXPECT_EQ(client.Line(), "0 \"\" 11 1 1 2 0.01 1.0");
  EXPECT_THAT(client.Line(), HasSubstr("2.0 2.0 0.01 1.0"));
}

TEST_F(RobotHostTest, StepOfAnotherThreadAnswersAllWhoWait) {
  world_.StepInline();
  const auto host = Start(Options());
  TestClient one = Connect("/robot1/motors"), two = Connect("/robot2/motors");
  for (int k = 1; k <= 50; ++k) {
    one.Send("set_velocity 0.2 0\n");
    two.Send("set_velocity 0.1 0\n");
    const std::string step = " " + std::to_string(k) + ".0";
    EXPECT_THAT(one.Line(), testing::EndsWith(step));
    EXPECT_THAT(two.Line(), testing::EndsWith(step));
  }
}

TEST_F(RobotHostTest, KeptRobotKeepsPortConnectionAndOwnerOverALoad) {
  const auto host = Start(Options());
  const int port = names_.Find("/robot1/motors")->port;
  TestClient client = TestClient::Connect(port);
  client.Send("claim\n");
  EXPECT_THAT(client.Line(), HasSubstr("0 \"\" 7"));
  TestClient leaving = Connect("/robot2/pose");
  leaving.Send("ping\n");
  leaving.Line();

  Load(SmallScenario(1));
  ASSERT_EQ(host->Apply(scene(), false), "");
  EXPECT_EQ(names_.Find("/robot1/motors")->port, port);
  EXPECT_FALSE(names_.Find("/robot2/pose"));
  EXPECT_THAT(leaving.Line(), HasSubstr("robot2 is not in the new scenario"));
  EXPECT_NE(world_.board.Owners()[0].id, 0u);
  client.Send("release\n");
  EXPECT_THAT(client.Line(), HasSubstr("0 \"\" 8"));
  EXPECT_EQ(host->thread_count(), 1u);
}

// For the sanitizers: a step may be about to wake the thread that a load ends. On one core a load at a random
// moment interrupts the step anywhere, including there.
TEST_F(RobotHostTest, ALoadWithoutASubscribedRobotEndsItsThreadWhileStepsRun) {
  constexpr int kLoads = 300;
  const OneCore one_core;
  auto both = std::make_shared<Scenario>(*SmallScenario(2));
  auto one = std::make_shared<Scenario>(*both);
  one->robots.pop_back();
  Load(both);
  const auto host = Start(Options());
  ASSERT_EQ(host->thread_count(), 2u);
  Stepping stepping(world_);
  std::minstd_rand random;
  for (int i = 0; i < kLoads; ++i) {
    auto [near, far] = SocketPair();
    names_.Find("/robot2/pose")->adopt(far.Release(), "subscribe\n", {"watcher", true}, nullptr);
    TestClient watcher(std::move(near));
    watcher.Line();
    EXPECT_THAT(watcher.Line(), HasSubstr(" -"));
    stepping.Between([&] { Load(one); });
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 200));
    ASSERT_EQ(host->Apply(scene(), false), "");
    watcher.Close();
    stepping.Between([&] { Load(both); });
    ASSERT_EQ(host->Apply(scene(), false), "");
  }
}

TEST_F(RobotHostTest, RobotOfAnotherTypeIsANewOne) {
  const auto host = Start(Options());
  TestClient client = Connect("/robot1/motors");
  client.Send("claim\n");
  client.Line();
  auto scenario = std::make_shared<Scenario>(*SmallScenario(2));
  scenario->robots[0].model = SmallModel("other");
  Load(scenario);
  ASSERT_EQ(host->Apply(scene(), false), "");
  EXPECT_TRUE(host->robots()[0]->Is(*scene()->robots[0].entry.model));
  EXPECT_EQ(client.Line().substr(0, 2), "0 ") << "a closing notice";
  EXPECT_EQ(world_.board.Owners()[0].id, 0u);
}

TEST_F(RobotHostTest, BusyPortAtTheStartIsNamed) {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(fd, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(fd, 1), 0);
  ASSERT_EQ(getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const int busy = ntohs(address.sin_port);
  PortPlan plan(busy);
  RobotHost host(Services(), Options(), plan);
  const std::string error = host.Apply(scene(), true);
  EXPECT_THAT(error, HasSubstr(std::to_string(busy)));
  EXPECT_THAT(error, HasSubstr("/robot1/motors"));
  EXPECT_TRUE(names_.List().empty());
  EXPECT_EQ(host.Apply(scene(), false), "") << "later the next free one is taken";
  EXPECT_GT(names_.Find("/robot1/motors")->port, busy);
  close(fd);
}

TEST_F(RobotHostTest, AnyFreePortsAreTriedOneAfterTheOther) {
  const auto host = Start(Options());
  int last = 0;
  for (const auto& robot : host->robots()) {
    for (std::size_t i = 0; i < robot->module_count(); ++i) {
      EXPECT_GT(robot->port(i), last) << "to let the system search takes long when thousands are in use";
      last = robot->port(i);
    }
  }
}

TEST_F(RobotHostTest, WithoutSocketsNamesAreListedWithPortZero) {
  auto scenario = std::make_shared<Scenario>(*SmallScenario(2));
  scenario->robots[0].sockets = false;
  Load(scenario);
  const auto host = Start(Options());
  EXPECT_EQ(names_.Find("/robot1/motors")->port, 0);
  EXPECT_NE(names_.Find("/robot2/motors")->port, 0);
  int pair[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, pair), 0);
  names_.Find("/robot1/pose")->adopt(pair[1], "get_pose\n", {"page", true}, nullptr);
  char bytes[5] = {};
  EXPECT_EQ(read(pair[0], bytes, 4), 4);
  EXPECT_EQ(std::string(bytes), "0 \"\"");
  close(pair[0]);
}

TEST_F(RobotHostTest, UpToSixtyFourRobotsWithSocketsHaveAThreadEachOnAnyMachine) {
  EXPECT_EQ(ThreadsFor(4, true, 2), 4u);
  EXPECT_EQ(ThreadsFor(64, true, 1), 64u);
}

TEST_F(RobotHostTest, BeyondSixtyFourAllShareAPool) {
  EXPECT_EQ(ThreadsFor(65, true, 2), 1u);
  EXPECT_EQ(ThreadsFor(65, true, 8), 2u);
}

TEST_F(RobotHostTest, RobotsWithoutSocketsDoNotCountAndShareAPool) {
  auto scenario = std::make_shared<Scenario>(*SmallScenario(67));
  for (std::size_t i = 3; i < scenario->robots.size(); ++i) scenario->robots[i].sockets = false;
  Load(scenario);
  EXPECT_EQ(Start(Options())->thread_count(), 3u + 2u);
  EXPECT_EQ(ThreadsFor(30, false, 2), 1u);
}

TEST_F(RobotHostTest, ManyRobotsShareAPool) {
  auto scenario = std::make_shared<Scenario>(*SmallScenario(101));
  for (RobotEntry& robot : scenario->robots) robot.sockets = false;
  Load(scenario);
  const auto host = Start(Options());
  EXPECT_EQ(host->thread_count(), 2u);
  EXPECT_EQ(names_.List().size(), 404u);
}

TEST_F(RobotHostTest, NumberOfThreadsCanBeChosen) {
  EXPECT_EQ(ThreadsFor(7, true, 8, 3), 3u);
  EXPECT_EQ(ThreadsFor(7, false, 8, 7), 7u);
}

TEST_F(RobotHostTest, StopTellsClientsAndTakesNamesAway) {
  const auto host = Start(Options());
  TestClient client = Connect("/robot1/motors");
  client.Send("ping\n");
  client.Line();
  host->Stop();
  EXPECT_THAT(client.Line(), HasSubstr("the daemon is stopping"));
  EXPECT_TRUE(names_.List().empty());
  EXPECT_EQ(host->thread_count(), 0u);
}

TEST_F(RobotHostTest, ThousandsComeAndGoInSlices) {
  const auto host = Start(Options());
  LoadSwarm(1000);
  host->Begin(scene());
  int slices = 1;
  while (!host->Resume()) {
    ++slices;
    EXPECT_LE(names_.List().size(), 2 * 4 + slices * RobotHost::kComeAtOnce * 4);
  }
  EXPECT_GT(slices, 1000U / RobotHost::kComeAtOnce);
  EXPECT_EQ(names_.List().size(), 4000U);

  Load(SmallScenario(1));
  host->Begin(scene());
  EXPECT_FALSE(host->Resume());
  EXPECT_GE(names_.List().size(), 4000 - 4 * RobotHost::kGoAtOnce);
  while (!host->Resume()) continue;
  EXPECT_EQ(names_.List().size(), 4U);
}

TEST_F(RobotHostTest, AKeptRobotServesWhileOthersCome) {
  const auto host = Start(Options());
  TestClient client = Connect("/robot2/motors");
  LoadSwarm(1000);
  host->Begin(scene());
  EXPECT_FALSE(host->Resume());
  client.Send("claim\n");
  EXPECT_THAT(client.Line(), HasSubstr("0 \"\" 7"));
  EXPECT_TRUE(host->CloseClient("robot2", world_.board.Owners()[1].id, "released by ana"));
  EXPECT_THAT(client.Line(), HasSubstr("released by ana"));
  EXPECT_FALSE(host->CloseClient("robot1000", 1, "released by ana")) << "it is still to come";
}

TEST_F(RobotHostTest, AnotherSceneTakesOverWhatHasCome) {
  const auto host = Start(Options());
  TestClient one = Connect("/robot1/motors"), two = Connect("/robot2/motors");
  LoadSwarm(1000);
  host->Begin(scene());
  EXPECT_FALSE(host->Resume());
  Load(SmallScenario(1));
  host->Begin(scene());
  Load(SmallScenario(3));
  host->Begin(scene());
  while (!host->Resume()) continue;
  ASSERT_EQ(host->robots().size(), 3U);
  EXPECT_EQ(names_.List().size(), 12U);
  one.Send("claim\n");
  EXPECT_THAT(one.Line(), HasSubstr("0 \"\" 7"));
  EXPECT_THAT(two.Line(), HasSubstr("robot2 is not in the new scenario")) << "in between it was not";
  TestClient again = Connect("/robot2/motors");
  again.Send("claim\n");
  EXPECT_THAT(again.Line(), HasSubstr("0 \"\" 7"));
}

TEST_F(RobotHostTest, AStopBetweenSlicesEndsWhatHasComeAndWhatIsToLeave) {
  const auto host = Start(Options());
  LoadSwarm(1000);
  host->Begin(scene());
  EXPECT_FALSE(host->Resume());
  Load(SmallScenario(0));
  host->Begin(scene());
  host->Stop();
  EXPECT_TRUE(names_.List().empty());
  EXPECT_TRUE(host->Resume());
  EXPECT_TRUE(host->robots().empty());
}

TEST_F(RobotHostTest, OwnerIsClosedWithTheReason) {
  const auto host = Start(Options());
  TestClient client = Connect("/robot1/motors");
  client.Send("claim\n");
  client.Line();
  EXPECT_TRUE(host->CloseClient("robot1", world_.board.Owners()[0].id, "released by ana"));
  EXPECT_THAT(client.Line(), HasSubstr("released by ana"));
  EXPECT_FALSE(host->CloseClient("robot9", 1, "released by ana"));
}

}  // namespace
}  // namespace coopdyn
