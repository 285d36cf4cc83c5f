// SPDX-License-Identifier: MIT
// The robots of the current scenario, their threads and ports. One thread: control, or main before control
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
  bool sockets = true;                 // false: `--no-net`, modules can only adopt connections
  std::vector<std::string> addresses;  // ListenAddresses(--host)
  int threads = 0;  // `--robot-threads`, for all robots; 0: one each for robots with sockets, else a pool
  std::chrono::microseconds spin{0};    // IoThread
  std::size_t cores = 0;                // 0: all of this machine
  PortPlan* channel_ports = nullptr;    // for channels, i.e. clients of YARS; null: like all other modules
  bool requested_channel_ports = true;  // channels first try the port of their model
  std::string channel_ports_file{};     // prefix of the files that hold channels' ports; empty: none
};

class RobotHost {
 public:
  /// Up to this many robots with sockets run in a thread each. With more, all robots share a pool. Robots
  /// without sockets (of swarms) always do.
  static constexpr std::size_t kMaxOwnThreads = 64;
  /// Size of the pool: one thread per this many robots, at most kMaxPool and at most half the cores, because
  /// clients need the others.
  static constexpr std::size_t kRobotsPerThread = 4, kMaxPool = 2;
  /// Robots removed or added per Resume(): a few milliseconds, tens of them with sockets. Removal visits each
  /// thread only twice, so more are removed.
  static constexpr std::size_t kGoAtOnce = 256, kComeAtOnce = 32;

  /// `services` and `ports` outlive it.
  RobotHost(RobotServices services, RobotHostOptions options, PortPlan& ports);
  /// Calls Stop().
  ~RobotHost();
  RobotHost(const RobotHost&) = delete;
  RobotHost& operator=(const RobotHost&) = delete;

  /// Starts to bring up the robots of `scene`, even while those of another one are not all up. Robots of the
  /// same name and type are unchanged, with ports, connections and owners; the others are closed with a
  /// notice. Call it once the board is configured for the scene.
  void Begin(std::shared_ptr<const Scene> scene);
  /// Continues for a while: other work can run between calls. Returns true once all robots are up.
  bool Resume();
  /// Begin() and Resume() until all robots are up. A busy port with `at_start` is an error: returns a text
  /// that names it, and no robots stay up. Otherwise takes the next free port. Returns "" on success.
  std::string Apply(std::shared_ptr<const Scene> scene, bool at_start);
  /// Calls Robot::OpenYarpPort() of the robot whose name begins `name`, if it has sockets.
  void OpenYarpPort(const std::string& name, const std::string& asker);
  /// Closes a connection to `robot` with a notice. Returns false if there is no such robot.
  bool CloseClient(const std::string& robot, ClientId client, const std::string& reason);
  /// Closes all connections with a notice, removes all names, ends the threads.
  void Stop(const std::string& reason = "the daemon is stopping");
  void SetSpin(std::chrono::microseconds spin);

  /// In the scene's order; null: not up yet.
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
  /// The state between Begin() and the end of the change.
  struct Change {
    std::shared_ptr<const Scene> scene;
    std::unordered_map<std::string_view, std::size_t> places;  // of the scene's robots, by name
    std::deque<std::unique_ptr<Robot>> leaving;  // removed first, because their names and ports may be needed
    std::size_t next = 0;                        // all earlier ones are up
    bool own_threads = false;
    bool at_start = false;
    bool out_of_files = false;  // while opening ports: retrying for each module would take long
    std::string error;
  };
  struct Thread {
    std::unique_ptr<IoThread> io;
    const Robot* only = nullptr;  // its only robot; null: in the pool
  };

  bool HasSockets(const RobotEntry& entry) const { return options_.sockets && entry.sockets; }
  /// A thread for a robot of `scene`; `own`: exclusively.
  IoThread& ThreadFor(const Scene& scene, bool own);
  /// Removes or adds the next robots.
  void LetGo();
  void BringUp();
  /// All robots are up: drops the remains of removed robots.
  void End();
  void Open(Robot& robot, const RobotEntry& entry);
  PortPlan& PlanFor(const Robot& robot, std::size_t module) {
    return options_.channel_ports != nullptr && robot.is_channel(module) ? *options_.channel_ports : ports_;
  }
  std::string ChannelFile(const std::string& robot) const {
    return options_.channel_ports_file + "-" + robot;
  }
  /// Records that a channel's port belongs to its robot from now on.
  void NoteChannel(const Robot& robot, std::size_t module);
  /// Removes the port file of a robot that no longer has a channel.
  void ForgetFile(const std::string& robot);
  /// Keeps ports and connections of the channels of `robot`, which is removed, for their successors on these
  /// ports. Without a successor they end, for the reason `why`, once the new robots are up.
  void Release(Robot& robot, const std::string& why);
  /// Makes the channel listen on the port that its robot had before, else on the port of a removed robot.
  /// Returns false if there is none.
  bool ListenAsBefore(Robot& robot, std::size_t module);
  std::string OpenModule(Robot& robot, std::size_t module);
  /// At the start, sets the error; later, LogFailures() logs one line per `what` with the number of failures.
  void Fail(const std::string& who, const std::string& what);
  void NoteFailure(const std::string& who, const std::string& what);
  void LogFailures();
  /// Visits each thread twice, not each robot: that would take seconds with thousands of robots.
  void Drop(std::vector<std::unique_ptr<Robot>> robots,
            const std::function<std::string(const Robot&)>& reason);

  const RobotServices services_;
  RobotHostOptions options_;
  PortPlan& ports_;
  std::vector<Thread> threads_;
  std::size_t next_of_pool_ = 0;
  std::vector<std::unique_ptr<Robot>> robots_;
  std::optional<Change> change_;                             // nullopt: all are up
  std::unordered_map<std::string, int> last_channel_ports_;  // by robot, so its client can stay on its port
  std::map<std::string, Affected> failures_;                 // by cause; until all are up
  // Until all are up: data of removed robots.
  std::deque<int> freed_channel_ports_;   // of robots not in the new scene, in order
  std::set<int> vacant_;                  // ports of all their channels
  std::vector<std::string> had_channel_;  // their names
  std::unordered_map<int, Left> left_;    // by port
};

}  // namespace coopdyn
