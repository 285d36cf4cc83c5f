// SPDX-License-Identifier: MIT
// The options of `coopdyn serve` and `play`. Flags override COOPDYN_* variables, which override the config
// file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/controllers/controller_set.h"
#include "server/model/readers.h"
#include "server/model/settings.h"
#include "server/physics/stepper.h"
#include "server/record/recorded_step.h"

namespace coopdyn {

/// The parts to record, and the files.
struct RecordOptions {
  std::string file;                // recording from the start; empty: none
  std::string folder = ".";        // folder of recordings started later
  std::optional<RecordWhat> what;  // nullopt: depends on the number of robots
  bool durable = false;            // each step is on the disk before it is answered
  Nanoseconds every = 0;           // interval of poses and readings; 0: each step
  bool force = false;
  bool stop_on_failure = false;
};

/// `coopdyn play`.
struct PlayRun {
  std::string file;  // empty: a live run
  double speed = 1;
  Nanoseconds start = 0;
  bool loop = false, paused = false;
};

struct ServeOptions {
  std::string scenario = "classroom";        // path, bare name or pipe
  std::optional<std::string> scenario_text;  // read from the pipe
  Settings settings;                         // of the scenario
  std::string from;                          // RUN@TIME, instead of the scenario
  PlayRun play;                              // instead of both
  RecordOptions record;
  RunOptions run;
  int port = 10000;
  bool any_port = false;  // use other free ports if those are in use
  std::optional<int> name_port, http_port;
  std::optional<int> channel_port;  // first port for clients of YARS
  std::string channel_ports_file;   // prefix of files that list these ports; empty: none
  bool channel_quits = false;       // clients of YARS may end the daemon
  std::vector<std::string> hosts;   // empty: loopback
  std::string advertise;
  std::string token;
  bool weak_token = false;            // accept a short token
  bool token_for_all = false;         // programs of this machine need it, too
  std::string yarp_server;            // HOST:PORT; empty: own name server only
  std::string yarp_dialect = "auto";  // of readers: "3", "4", or "auto" to ask each reader
  std::string seat;                   // the socket by which `coopdyn host` passes connections; empty: none
  bool seat_ports = false;            // the daemon of a seat also has its own ports, for admitted machines
  std::string seat_url;               // of the page, as the host serves it
  bool private_robots = false;
  bool read_only = false;
  bool no_render = false, no_http = false, no_net = false;
  double render_fps = 10;
  std::string renderer = "auto";  // auto, osmesa, egl
  std::optional<int> robot_threads;
  int threads = 1;  // of sensing, controllers and physics
  bool controllers_in_process = false;
  std::optional<std::uint64_t> controller_memory_bytes;  // 0: no limit
  std::optional<int> spin_us;
  std::string log_level = "info";
  std::string log_file;  // empty: only stderr
  std::string summary_file;
  std::optional<int> with_process;  // end with this process
  std::vector<std::string> scenario_folders;
  bool strict = false;       // a missing mesh is an error
  std::string command_line;  // as given; stored in recordings
};

/// Runs the daemon until something ends it. Returns the exit code.
int Serve(ServeOptions options);

/// The number of threads that share a step, at most the number of cores. Results do not depend on it.
int ThreadsOf(const ServeOptions& options);
/// RUN and TIME of RUN@TIME, split at the last @; two empty texts if either is missing.
std::pair<std::string, std::string> SplitMoment(const std::string& from);
ControllerOptions ControllersOf(const ServeOptions& options);
bool IsLoopback(const std::string& host);
/// Whether other machines can reach the daemon.
bool BeyondLoopback(const ServeOptions& options);
/// Number of ports from --port on that belong to names, page and modules, unless modules use any free port.
inline constexpr int kOwnPorts = 2000;
bool IsOwnPort(const ServeOptions& options, int port);

/// The search path: the given folders, COOPDYN_PATH, then the data beside the program; for models' files also
/// those of AddModelFolders().
SearchPath DataPath(const std::vector<std::string>& given);
/// Adds the model folders that the environment names for Gazebo and ROS, and Gazebo's download folders.
void AddModelFolders(SearchPath& path);

inline constexpr const char* kStrictHelp =
    "In files of other programs, too, what is named and is not there is an error: a mesh that collides, an "
    "<include> of a world";

inline constexpr const char* kVersion = "0.1.0";

}  // namespace coopdyn
