// SPDX-License-Identifier: MIT
// The daemon: everything that `coopdyn serve` runs, wired together, started and stopped in order. Main
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
  /// Nothing runs yet. `shutdown` outlives it.
  Daemon(const ServeOptions& options, Logger logger, Shutdown& shutdown);
  /// Stop().
  ~Daemon() override;

  /// Reads the scenario, builds its physics, opens all ports, starts all threads. An error text of one or
  /// more lines, empty if everything listens.
  std::string Start();
  /// Ends everything in order: physics (which answers all waits), robots, control, page, render. Again does
  /// nothing.
  void Stop();

  /// The line `ready names=HOST:PORT http=URL robots=N`.
  std::string ReadyLine() const;
  /// `opened port N for ROBOT` of each: what programs look for that start YARS.
  std::vector<std::string> ChannelLines() const;
  /// For people: the page, and how to go on from MATLAB, Python and telnet.
  std::string HowToGoOn() const;
  FramePtr frame() const { return frames_.Latest(); }
  RunStatus status() const { return run_.status(); }
  /// How the run stands, or has ended. `wall_s`: how long it has taken.
  RunReport report(double wall_s) const;
  /// Follows a mode that was switched: `--spin` is for lockstep. Called now and then.
  void UpdateSpin();
  /// Says in the log and to clients, now and then, who takes the time if the run loses real time.
  void WatchPace();
  /// Says in the log, now and then, whom a lockstep world waits for. Called now and then.
  void LogWaiting();

 private:
  // ControlActions, on the control thread.
  void CloseClient(const std::string& robot, ClientId client, const std::string& reason) override;
  void Quit() override;
  std::string recording() const override { return recordings_.recording(); }
  std::uint64_t recording_lost() const override { return recordings_.status().file.lost; }
  std::string recording_stall() const override { return recordings_.status().file.stall; }
  std::string http() const override;

  /// The robots' modules follow the scene, slice by slice; then `done`. Control thread.
  void ApplyScene(std::shared_ptr<const Scene> scene, std::function<void()> done);
  void GoOnApplying();

  // daemon_yarp.cc
  /// YarpPorts::Open() if `name` is a port of a module. Control thread.
  void OpenYarpPort(const std::string& name, const std::string& asker);
  /// Closes, from time to time, the ports that nobody uses. Control thread.
  void SweepYarpPorts();
  /// Once somebody has asked for /clock: keeps it alive while time stands. Control thread.
  void RepeatClock();
  /// Tells the other name server (`--yarp-server`) which of our names have come and gone.
  void TellYarpServer();

  // daemon_world.cc: an error text, empty if the world stands.
  std::string StartWorld();
  std::string StartScenario();
  std::string StartFromRecording();
  std::string StartPlayback();
  /// The robots of each scene that the player shows get their modules.
  void BringUpScenes();
  /// The physics thread: steps until a recording is opened, plays until a branch or a close, steps, …
  void RunWorld(const std::stop_token& stop);
  /// Plays what `play` says instead of the live run, whose state was `live` (null: there was none), and
  /// answers it. On the physics thread.
  void Play(const Edit& play, const SavedStatePtr& live);
  ReplayServices replay_services();
  RecordingOptions recording_options();

  Encodings AllEncodings();
  std::string OpenNames();
  std::string OpenRobots();
  std::string OpenGlobalModules();
  /// /simulation and the others, once they are open.
  std::vector<Endpoint*> GlobalModules() const;
  std::string OpenPage();
  /// The way by which `coopdyn host` passes connections.
  std::string OpenSeat();
  /// What the run has cost so far. Any thread.
  CostSnapshot Costs() const;
  std::chrono::microseconds Spin() const;
  /// Whether it has ports of its own.
  bool listens() const { return !options_.no_net && options_.seat.empty(); }
  /// Where its ports listen.
  std::vector<std::string> addresses() const;
  /// The address that other programs should use.
  std::string told_host() const;

  const ServeOptions options_;
  const Logger logger_;
  Shutdown& shutdown_;
  const SteadyClock clock_;
  const std::string token_;

  // State that threads share; outlives them all.
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

  WorkerPool pool_;             // of whoever holds the step baton
  ControllerHost controllers_;  // likewise
  Stepper stepper_;
  RecordingDesk recordings_;
  BranchDesk branches_;
  RunFolder runs_;
  IoThread loader_;                 // reads scenarios that are loaded
  std::unique_ptr<Player> player_;  // of the recording that is played; null in a live run
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
  std::vector<std::unique_ptr<NamedPort>> published_;  // of the five above
  std::unique_ptr<NameServer> name_server_;
  std::unique_ptr<PassedDoor> seat_door_;
  std::optional<boost::asio::steady_timer> clock_timer_, sweep_timer_;
  std::unique_ptr<NameClient> name_client_;
  std::map<std::string, int> told_names_;  // to the other name server: name, port
  std::unique_ptr<PageServices> page_;     // of web_
  std::unique_ptr<WebServer> web_;
  std::jthread physics_;
  /// Of each ApplyScene() whose robots are not all up; control thread.
  std::vector<std::function<void()>> applied_;
  bool opens_yarp_ports_ = false;  // the robots are up; control thread
  bool stopped_ = false;
  OverloadWatch overload_;          // main thread
  Nanoseconds waiting_logged_ = 0;  // when LogWaiting() last said something; 0: nobody is awaited
};

}  // namespace coopdyn
