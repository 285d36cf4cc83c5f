// SPDX-License-Identifier: MIT
// The robots of the scenario in force, their threads and ports. One thread: control, or main before that
// runs.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <string>
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

  /// `services` and `ports` outlive it.
  RobotHost(RobotServices services, RobotHostOptions options, PortPlan& ports);
  /// Stop().
  ~RobotHost();
  RobotHost(const RobotHost&) = delete;
  RobotHost& operator=(const RobotHost&) = delete;

  /// Brings up the robots of `scene`. Those that keep name and type stay as they are, with ports, connections
  /// and owners; the others are closed with a notice. To be called when the board has been configured for the
  /// scene. A busy port: with `at_start` an error text that names it, and nothing is brought up; otherwise
  /// the next free one is taken. Returns "" if all is well.
  std::string Apply(const Scene& scene, bool at_start);
  /// Robot::OpenYarpPort() of the robot whose name begins `name`, if it has sockets.
  void OpenYarpPort(const std::string& name, const std::string& asker);
  /// Closes a connection to `robot` with a notice. False if there is no such robot.
  bool CloseClient(const std::string& robot, ClientId client, const std::string& reason);
  /// From now on Apply() brings nothing up any more: the program ends. Any thread.
  void Interrupt() { interrupted_ = true; }
  /// Closes all connections with a notice, takes all names away, ends the threads.
  void Stop(const std::string& reason = "the daemon is stopping");
  void SetSpin(std::chrono::microseconds spin);

  const std::vector<std::unique_ptr<Robot>>& robots() const { return robots_; }  // in the scene's order
  std::size_t thread_count() const;

 private:
  struct Left {
    LoosePort port;
    std::string why;
  };
  struct Thread {
    std::unique_ptr<IoThread> io;
    const Robot* only = nullptr;  // whose own it is; null: of the pool
  };

  bool HasSockets(const RobotEntry& entry) const { return options_.sockets && entry.sockets; }
  /// A thread for a robot of `scene`; `own`: for it alone.
  IoThread& ThreadFor(const Scene& scene, bool own);
  std::string Open(Robot& robot, const RobotEntry& entry, bool at_start);
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
  /// The ports of `robot`, which is not in the new scene, are free for robots that are new in it.
  void FreeChannels(const Robot& robot);
  /// What the channels of `robot`, which goes, leave to those that get their ports; else, when the new robots
  /// are up, it ends for the reason `why`.
  void Release(Robot& robot, const std::string& why);
  /// The channel listens on the port that its robot had before, or else on one of a robot that is gone.
  bool ListenAsBefore(Robot& robot, std::size_t module);
  std::string OpenModule(Robot& robot, std::size_t module, bool at_start);
  /// Visits each thread twice, not each robot: with thousands of them that would take seconds.
  void Drop(std::vector<std::unique_ptr<Robot>> robots,
            const std::function<std::string(const Robot&)>& reason);

  const RobotServices services_;
  RobotHostOptions options_;
  PortPlan& ports_;
  std::atomic<bool> interrupted_{false};
  std::vector<Thread> threads_;
  std::size_t next_of_pool_ = 0;
  std::vector<std::unique_ptr<Robot>> robots_;
  std::unordered_map<std::string, int> last_channel_ports_;  // by robot: its client stays where it is
  std::deque<int> freed_channel_ports_;  // of robots that are not in the new scene, in their order
  std::unordered_map<int, Left> left_;   // by port, within Apply()
};

}  // namespace coopdyn
