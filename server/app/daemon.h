// SPDX-License-Identifier: MIT
// The daemon: wires together everything that `coopdyn serve` runs, and starts and stops it in order. Main
// thread.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/steady_timer.hpp>

#include "server/app/options.h"
#include "server/app/page_services.h"
#include "server/app/run_report.h"
#include "server/app/shutdown.h"
#include "server/app/yars_desk.h"
#include "server/base/log.h"
#include "server/base/worker_pool.h"
#include "server/control/branch_desk.h"
#include "server/control/record_modules.h"
#include "server/control/recording_desk.h"
#include "server/control/run_folder.h"
#include "server/control/simulation_module.h"
#include "server/control/swarm_module.h"
#include "server/control/world_module.h"
#include "server/controllers/controller_host.h"
#include "server/naming/name_client.h"
#include "server/naming/name_server.h"
#include "server/naming/named_port.h"
#include "server/net/passed_socket.h"
#include "server/record/player.h"
#include "server/render/render_thread.h"
#include "server/replay/state_at.h"
#include "server/robot/robot_host.h"
#include "server/state/image_board.h"
#include "server/timing/overload_watch.h"
#include "server/web/web_server.h"
#include "server/yarp/encoding.h"
#include "server/yarp/network.h"
#include "server/yarp/yarp_ports.h"
#include "server/yars/tcp_encoding.h"

namespace coopdyn {

class Daemon final : private ControlActions {
 public:
  /// Starts nothing yet. `shutdown` must outlive the daemon.
  Daemon(const ServeOptions& options, Logger logger, Shutdown& shutdown);
  /// Calls Stop().
  ~Daemon() override;

  /// Reads the scenario, builds its physics, opens all ports and starts all threads. Returns an error text of
  /// one or more lines, empty on success.
  std::string Start();
  /// Ends everything in order: physics (which answers all pending requests), robots, control, page, render.
  /// Further calls do nothing.
  void Stop();

  /// The line `ready names=HOST:PORT http=URL robots=N`.
  std::string ReadyLine() const;
  /// A line `opened port N for ROBOT` per channel, which programs that start YARS look for.
  std::vector<std::string> ChannelLines() const;
  /// The hints printed at the start: the page's URL, and how to connect from MATLAB, Python and telnet.
  std::string ConnectHints() const;
  FramePtr frame() const { return frames_.Latest(); }
  RunStatus status() const { return run_.status(); }
  /// The state or the result of the run. `wall_s`: its wall time so far.
  RunReport report(double wall_s) const;
  /// Adapts `--spin` to the current mode: spinning is for lockstep. Called periodically.
  void UpdateSpin();
  /// Warns in the log and as an event when the run loses real time, with the most expensive parts. Called
  /// periodically.
  void WatchPace();
  /// Logs which robot a lockstep world waits for. Called periodically.
  void LogWaiting();

 private:
  // ControlActions, on the control thread.
  void CloseClient(const std::string& robot, ClientId client, const std::string& reason) override;
  void Quit() override;
  std::string recording() const override { return recordings_.recording(); }
  std::uint64_t recording_lost() const override { return recordings_.status().file.lost; }
  std::string recording_stall() const override { return recordings_.status().file.stall; }
  std::string http() const override;

  /// Updates the robots' modules to `scene`, slice by slice, then calls `done`. Control thread.
  void ApplyScene(std::shared_ptr<const Scene> scene, std::function<void()> done);
  void ResumeApplying();

  // daemon_yarp.cc
  /// Calls YarpPorts::Open() if `name` is a port of a module. Control thread.
  void OpenYarpPort(const std::string& name, const std::string& asker);
  /// Periodically closes unused YARP ports. Control thread.
  void SweepYarpPorts();
  /// Once a program has opened /clock, repeats its time while the run stands. Control thread.
  void RepeatClock();
  /// Registers new names of this daemon at the other name server (`--yarp-server`) and unregisters removed
  /// ones.
  void TellYarpServer();

  // daemon_world.cc. Each returns an error text, empty if the world is ready.
  std::string StartWorld();
  std::string StartScenario();
  std::string StartFromRecording();
  std::string StartPlayback();
  /// Makes the player bring up the modules of each scene that it shows.
  void BringUpScenes();
  /// Main function of the physics thread: alternates between stepping, until a recording is opened, and
  /// playing, until a branch or a close.
  void RunWorld(const std::stop_token& stop);
  /// Switches to the recording of `play` from the live run, whose state was `live` (null: from another
  /// playback), and answers `play`. On the physics thread.
  void Play(const Edit& play, const SavedStatePtr& live);
  ReplayServices replay_services();
  RecordingOptions recording_options();

  Encodings AllEncodings();
  std::string OpenNames();
  std::string OpenRobots();
  std::string OpenGlobalModules();
  /// The global modules, /simulation first; null before they are open.
  std::vector<Endpoint*> GlobalModules() const;
  std::string OpenPage();
  /// Opens the socket by which `coopdyn host` passes connections.
  std::string OpenSeat();
  /// The costs of the run so far. Any thread.
  CostSnapshot Costs() const;
  std::chrono::microseconds Spin() const;
  /// Whether it has ports of its own.
  bool listens() const { return !options_.no_net && (options_.seat.empty() || options_.seat_ports); }
  /// The addresses on which the ports listen.
  std::vector<std::string> addresses() const;
  /// The address that other programs should use.
  std::string advertised_host() const;

  const ServeOptions options_;
  const Logger logger_;
  Shutdown& shutdown_;
  const SteadyClock clock_;
  const std::string token_;

  // State shared by threads; outlives all of them.
  Doorbell bell_;
  FrameBoard frames_;
  CommandBoard board_;
  EditQueue edits_{bell_};
  RunControl run_;
  ImageBoard images_;
  const std::filesystem::path uploads_;  // a folder of models_
  RobotLibrary models_;
  NameTable names_;
  YarpNetwork yarp_;
  NetServices net_;
  ConnectionRoster roster_;
  WrongTokens wrong_tokens_;
  const TokenGuard robot_guard_, control_guard_;
  PortPlan ports_, channel_ports_;
  YarpPorts yarp_ports_;

  WorkerPool pool_;             // used by the holder of the baton
  ControllerHost controllers_;  // used by the holder of the baton
  Stepper stepper_;
  RecordingDesk recordings_;
  BranchDesk branches_;
  RunFolder runs_;
  IoThread loader_;                 // reads scenarios to load
  std::unique_ptr<Player> player_;  // null in a live run
  std::unique_ptr<RenderThread> render_;
  IoThread control_;
  YarsDesk yars_desk_;
  YarsPorts yars_ports_;
  std::unique_ptr<RobotHost> robots_;
  std::unique_ptr<SimulationModule> simulation_;
  std::unique_ptr<WorldModule> world_;
  std::unique_ptr<SwarmModule> swarm_;
  std::unique_ptr<PlaybackModule> playback_;
  std::unique_ptr<RecorderModule> recorder_;
  std::vector<std::unique_ptr<NamedPort>> published_;  // of the five modules above
  std::unique_ptr<NameServer> name_server_;
  std::unique_ptr<PassedDoor> seat_door_;
  std::optional<boost::asio::steady_timer> clock_timer_, sweep_timer_;
  std::unique_ptr<NameClient> name_client_;
  std::map<std::string, int> registered_names_;  // registered at the other name server: name, port
  std::unique_ptr<PageServices> page_;           // used by web_
  std::unique_ptr<WebServer> web_;
  std::jthread physics_;
  /// `done` of each ApplyScene() in progress; control thread.
  std::vector<std::function<void()>> applied_;
  bool opens_yarp_ports_ = false;  // the robots are up; control thread
  bool stopped_ = false;
  OverloadWatch overload_;          // main thread
  Nanoseconds waiting_logged_ = 0;  // time of the last log line of LogWaiting(); 0 while no robot is awaited
};

}  // namespace coopdyn
