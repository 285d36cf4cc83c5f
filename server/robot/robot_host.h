// SPDX-License-Identifier: MIT
// The robots of the scenario in force, their threads and ports. One thread: control, or main before that
// runs.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "server/net/io_thread.h"
#include "server/robot/port_plan.h"
#include "server/robot/robot.h"
#include "server/robot/robot_core.h"
#include "server/state/scene.h"

namespace coopdyn {

struct RobotHostOptions {
  bool sockets = true;                 // false: `--no-net`, modules can only adopt
  std::vector<std::string> addresses;  // ListenAddresses(--host)
  int threads = 0;  // `--robot-threads`: for all robots; 0: one each for those with sockets, else a pool
  std::chrono::microseconds spin{0};  // IoThread
  std::size_t cores = 0;              // 0: those of this machine
  PortPlan* channel_ports = nullptr;  // of modules for clients of YARS; null: as all others
  bool said_channel_ports = true;     // they try that of their model first
  std::string channel_ports_file{};   // begins the names of files that have these ports; empty: none
};

class RobotHost {
 public:
  /// Each robot with sockets of its own runs in its own thread as long as no more have some; beyond that all,
  /// and those without sockets (of swarms) always, share a pool.
  static constexpr std::size_t kMaxOwnThreads = 64;
  /// The pool: one thread for this many robots, at most kMaxPool and half the cores, as their clients need
  /// the others.
  static constexpr std::size_t kRobotsPerThread = 4, kMaxPool = 2;
  /// The most that go or come in one GoOn(): a few milliseconds, tens if they have sockets. To let robots
  /// go takes two visits to each thread, so they are more.
  static constexpr std::size_t kGoAtOnce = 256, kComeAtOnce = 32;

  /// `services` and `ports` outlive it.
  RobotHost(RobotServices services, RobotHostOptions options, PortPlan& ports);
  /// Stop().
  ~RobotHost();
  RobotHost(const RobotHost&) = delete;
  RobotHost& operator=(const RobotHost&) = delete;

  /// Begins to bring up the robots of `scene`, also before those of another one are up. Those that keep name
  /// and type stay as they are, with ports, connections and owners; the others are closed with a notice. To
  /// be called when the board has been configured for the scene.
  void Begin(std::shared_ptr<const Scene> scene);
  /// Goes on with it for a while, so that others are served between two calls. True: all robots are up.
  bool GoOn();
  /// Both, until all are up. A busy port: with `at_start` an error text that names it, and nothing is brought
  /// up; otherwise, as after Begin(), the next free one is taken. Returns "" if all is well.
  std::string Apply(std::shared_ptr<const Scene> scene, bool at_start);
  /// Robot::OpenYarpPort() of the robot whose name begins `name`, if it has sockets.
  void OpenYarpPort(const std::string& name, const std::string& asker);
  /// Closes a connection to `robot` with a notice. False if there is no such robot.
  bool CloseClient(const std::string& robot, ClientId client, const std::string& reason);
  /// Closes all connections with a notice, takes all names away, ends the threads.
  void Stop(const std::string& reason = "the daemon is stopping");
  void SetSpin(std::chrono::microseconds spin);

  /// In the scene's order; null: it is still to come.
  const std::vector<std::unique_ptr<Robot>>& robots() const { return robots_; }
  std::size_t thread_count() const;

 private:
  struct Affected {
    std::string first;
    std::size_t more = 0;
  };
  struct Left {
    LoosePort port;
    std::string why;
  };
  /// What is under way between Begin() and the end.
  struct Change {
    std::shared_ptr<const Scene> scene;
    std::unordered_map<std::string_view, std::size_t> places;  // of its robots, by name
    std::deque<std::unique_ptr<Robot>> leaving;  // they go first: their names and ports may be wanted
    std::size_t next = 0;                        // all before are up
    bool own_threads = false;
    bool at_start = false;
    bool out_of_files = false;  // for ports: to try it again for each module would take long
    std::string error;
  };
  struct Thread {
    std::unique_ptr<IoThread> io;
    const Robot* only = nullptr;  // whose own it is; null: of the pool
  };

  bool HasSockets(const RobotEntry& entry) const { return options_.sockets && entry.sockets; }
  /// A thread for a robot of `scene`; `own`: for it alone.
  IoThread& ThreadFor(const Scene& scene, bool own);
  /// The next ones go; they come.
  void LetGo();
  void BringUp();
  /// All are up: what is left of those that are gone ends.
  void End();
  void Open(Robot& robot, const RobotEntry& entry);
  PortPlan& PlanFor(const Robot& robot, std::size_t module) {
    return options_.channel_ports != nullptr && robot.is_channel(module) ? *options_.channel_ports : ports_;
  }
  std::string ChannelFile(const std::string& robot) const {
    return options_.channel_ports_file + "-" + robot;
  }
  /// A channel listens on a port that is its robot's from now on.
  void NoteChannel(const Robot& robot, std::size_t module);
  /// A robot without a channel has no file of its port.
  void ForgetFile(const std::string& robot);
  /// What the channels of `robot`, which goes, leave to those that get their ports; else, when the new robots
  /// are up, it ends for the reason `why`.
  void Release(Robot& robot, const std::string& why);
  /// The channel listens on the port that its robot had before, or else on one of a robot that is gone.
  bool ListenAsBefore(Robot& robot, std::size_t module);
  std::string OpenModule(Robot& robot, std::size_t module);
  /// At the start an error; else LogFailures() says in one line for each `what` with how many it went wrong.
  void Fail(const std::string& who, const std::string& what);
  void NoteFailure(const std::string& who, const std::string& what);
  void LogFailures();
  /// Visits each thread twice, not each robot: with thousands of them that would take seconds.
  void Drop(std::vector<std::unique_ptr<Robot>> robots,
            const std::function<std::string(const Robot&)>& reason);

  const RobotServices services_;
  RobotHostOptions options_;
  PortPlan& ports_;
  std::vector<Thread> threads_;
  std::size_t next_of_pool_ = 0;
  std::vector<std::unique_ptr<Robot>> robots_;
  std::optional<Change> change_;                             // none: all are up
  std::unordered_map<std::string, int> last_channel_ports_;  // by robot: its client stays where it is
  std::map<std::string, Affected> failures_;                 // by what; until all are up
  // Until all are up: of robots that are gone.
  std::deque<int> freed_channel_ports_;   // of those that are not in the new scene, in their order
  std::set<int> vacant_;                  // ports of all their channels
  std::vector<std::string> had_channel_;  // names
  std::unordered_map<int, Left> left_;    // by port
};

}  // namespace coopdyn
