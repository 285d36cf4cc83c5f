// SPDX-License-Identifier: MIT
#include "server/robot/robot_host.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <set>
#include <string>

#include "server/net/listener.h"
#include "tests/server/devices/small_world.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;

class RobotHostTest : public testing::Test {
 protected:
  RobotServices Services() {
    return {world_.board, world_.frames, names_, net_, roster_, devices_, guard_, clock_, "1.2.3"};
  }
  RobotHostOptions Options() const { return {true, ListenAddresses("127.0.0.1"), 0, {}, 8}; }
  void Load(std::shared_ptr<const Scenario> scenario) { world_.Load(std::move(scenario), Mode::kLockstep); }
  const Scene& scene() const { return *world_.frames.Latest()->scene; }

  SteadyClock clock_;
  NameTable names_;
  NetServices net_{NullLogger(), clock_};
  ConnectionRoster roster_;
  DeviceFactory devices_;
  TokenGuard guard_{"", false};
  SmallWorld world_{2};
  PortPlan ports_{0};
};

/// A TCP connection to a loopback port, as a client of the text form.
class TextClient {
 public:
  explicit TextClient(int port) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    const timeval limit{5, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  }
  ~TextClient() { close(fd_); }
  TextClient(const TextClient&) = delete;
  TextClient& operator=(const TextClient&) = delete;

  bool connected() const { return connected_; }
  void Send(const std::string& line) { ASSERT_EQ(write(fd_, line.data(), line.size()), std::ssize(line)); }
  /// The next line; what came so far if the connection ends.
  std::string ReadLine() {
    std::string line;
    char c = 0;
    while (read(fd_, &c, 1) == 1 && c != '\n') line += c;
    return line;
  }

 private:
  int fd_;
  bool connected_ = false;
};

TEST_F(RobotHostTest, BringsUpEveryModuleWithNameAndPort) {
  RobotHost host(Services(), Options(), ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  std::set<int> ports;
  for (const char* name : {"/robot1/motors", "/robot1/distance", "/robot2/target", "/robot2/pose"}) {
    const auto entry = names_.Find(name);
    ASSERT_TRUE(entry) << name;
    ports.insert(entry->port);
    TextClient client(entry->port);
    EXPECT_TRUE(client.connected());
  }
  EXPECT_EQ(ports.size(), 4u);
  EXPECT_EQ(names_.List().size(), 8u);
  EXPECT_EQ(host.thread_count(), 2u);
}

TEST_F(RobotHostTest, AnswersOverItsSocketAndRunsAStep) {
  RobotHost host(Services(), Options(), ports_);
  world_.StepInline();
  Load(SmallScenario(1));
  ASSERT_EQ(host.Apply(scene(), true), "");
  TextClient client(names_.Find("/robot1/motors")->port);
  client.Send("set_velocity 0.2 0\nget_wheels\n");
  EXPECT_EQ(client.ReadLine(), "0 \"\" 11 1 1 2 0.01 1.0");
  EXPECT_THAT(client.ReadLine(), HasSubstr("2.0 2.0 0.01 1.0"));
}

TEST_F(RobotHostTest, StepOfAnotherThreadAnswersAllWhoWait) {
  RobotHost host(Services(), Options(), ports_);
  world_.StepInline();
  ASSERT_EQ(host.Apply(scene(), true), "");
  TextClient one(names_.Find("/robot1/motors")->port), two(names_.Find("/robot2/motors")->port);
  for (int k = 1; k <= 50; ++k) {
    one.Send("set_velocity 0.2 0\n");
    two.Send("set_velocity 0.1 0\n");
    const std::string step = " " + std::to_string(k) + ".0";
    EXPECT_THAT(one.ReadLine(), testing::EndsWith(step));
    EXPECT_THAT(two.ReadLine(), testing::EndsWith(step));
  }
}

TEST_F(RobotHostTest, KeptRobotKeepsPortConnectionAndOwnerOverALoad) {
  RobotHost host(Services(), Options(), ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  const int port = names_.Find("/robot1/motors")->port;
  TextClient client(port);
  client.Send("claim\n");
  EXPECT_THAT(client.ReadLine(), HasSubstr("0 \"\" 7"));
  TextClient leaving(names_.Find("/robot2/pose")->port);
  leaving.Send("ping\n");
  leaving.ReadLine();

  Load(SmallScenario(1));
  ASSERT_EQ(host.Apply(scene(), false), "");
  EXPECT_EQ(names_.Find("/robot1/motors")->port, port);
  EXPECT_FALSE(names_.Find("/robot2/pose"));
  EXPECT_THAT(leaving.ReadLine(), HasSubstr("robot2 is not in the new scenario"));
  EXPECT_NE(world_.board.Owners()[0].id, 0u);
  client.Send("release\n");
  EXPECT_THAT(client.ReadLine(), HasSubstr("0 \"\" 8"));
  EXPECT_EQ(host.thread_count(), 1u);
}

TEST_F(RobotHostTest, RobotOfAnotherTypeIsANewOne) {
  RobotHost host(Services(), Options(), ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  TextClient client(names_.Find("/robot1/motors")->port);
  client.Send("claim\n");
  client.ReadLine();
  auto scenario = std::make_shared<Scenario>(*SmallScenario(2));
  scenario->robots[0].model = SmallModel("other");
  Load(scenario);
  ASSERT_EQ(host.Apply(scene(), false), "");
  EXPECT_EQ(host.robots()[0]->type(), "other");
  EXPECT_EQ(client.ReadLine().substr(0, 2), "0 ") << "a closing notice";
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

TEST_F(RobotHostTest, WithoutSocketsNamesAreListedWithPortZero) {
  auto scenario = std::make_shared<Scenario>(*SmallScenario(2));
  scenario->robots[0].sockets = false;
  Load(scenario);
  RobotHost host(Services(), Options(), ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  EXPECT_EQ(names_.Find("/robot1/motors")->port, 0);
  EXPECT_NE(names_.Find("/robot2/motors")->port, 0);
  int pair[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, pair), 0);
  names_.Find("/robot1/pose")->adopt(pair[1], "get_pose\n", {"page", true});
  char bytes[5] = {};
  EXPECT_EQ(read(pair[0], bytes, 4), 4);
  EXPECT_EQ(std::string(bytes), "0 \"\"");
  close(pair[0]);
}

TEST_F(RobotHostTest, ManyRobotsShareOneThreadOfTwoCores) {
  Load(SmallScenario(30));
  RobotHostOptions options = Options();
  options.sockets = false;
  options.cores = 2;
  RobotHost host(Services(), options, ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  EXPECT_EQ(host.thread_count(), 1u);
}

TEST_F(RobotHostTest, ManyRobotsShareAPool) {
  auto scenario = std::make_shared<Scenario>(*SmallScenario(101));
  for (RobotEntry& robot : scenario->robots) robot.sockets = false;
  Load(scenario);
  RobotHost host(Services(), Options(), ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  EXPECT_EQ(host.thread_count(), 2u);
  EXPECT_EQ(names_.List().size(), 404u);
}

TEST_F(RobotHostTest, AFewRobotsShareOneThreadWhereCoresAreScarce) {
  Load(SmallScenario(4));
  RobotHostOptions options = Options();
  options.sockets = false;
  options.cores = 2;
  RobotHost host(Services(), options, ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  EXPECT_EQ(host.thread_count(), 1u);
}

TEST_F(RobotHostTest, EachRobotHasAThreadWhereCoresAreLeftForTheirClients) {
  Load(SmallScenario(7));
  RobotHostOptions options = Options();
  options.sockets = false;
  RobotHost host(Services(), options, ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  EXPECT_EQ(host.thread_count(), 7u);
}

TEST_F(RobotHostTest, NumberOfThreadsCanBeChosen) {
  Load(SmallScenario(7));
  RobotHostOptions options = Options();
  options.sockets = false;
  options.threads = 3;
  RobotHost host(Services(), options, ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  EXPECT_EQ(host.thread_count(), 3u);
}

TEST_F(RobotHostTest, StopTellsClientsAndTakesNamesAway) {
  RobotHost host(Services(), Options(), ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  TextClient client(names_.Find("/robot1/motors")->port);
  client.Send("ping\n");
  client.ReadLine();
  host.Stop();
  EXPECT_THAT(client.ReadLine(), HasSubstr("the daemon is stopping"));
  EXPECT_TRUE(names_.List().empty());
  EXPECT_EQ(host.thread_count(), 0u);
}

TEST_F(RobotHostTest, OwnerIsClosedWithTheReason) {
  RobotHost host(Services(), Options(), ports_);
  ASSERT_EQ(host.Apply(scene(), true), "");
  TextClient client(names_.Find("/robot1/motors")->port);
  client.Send("claim\n");
  client.ReadLine();
  EXPECT_TRUE(host.CloseClient("robot1", world_.board.Owners()[0].id, "released by ana"));
  EXPECT_THAT(client.ReadLine(), HasSubstr("released by ana"));
  EXPECT_FALSE(host.CloseClient("robot9", 1, "released by ana"));
}

}  // namespace
}  // namespace coopdyn
