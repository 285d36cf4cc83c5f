// SPDX-License-Identifier: MIT
// What `coopdyn serve` and `play` are asked for. Flags override COOPDYN_* variables, which override the
// config file.
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

/// What is recorded, and where.
struct RecordOptions {
  std::string file;                // from the start; empty: not
  std::string folder = ".";        // of recordings that are started later
  std::optional<RecordWhat> what;  // empty: as many robots there are
  bool durable = false;            // each step is on the disk before it is answered
  Nanoseconds every = 0;           // of poses and readings; 0: each step
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
  std::optional<std::string> scenario_text;  // what came through the pipe
  Settings settings;                         // of it
  std::string from;                          // RUN@TIME, instead of the scenario
  PlayRun play;                              // instead of both
  RecordOptions record;
  RunOptions run;
  int port = 10000;
  bool any_port = false;  // other free ones if those are in use
  std::optional<int> name_port, http_port;
  std::optional<int> channel_port;  // the first for clients of YARS
  std::string channel_ports_file;   // begins the names of files with these ports; empty: none
  bool channel_quits = false;       // they may end the daemon
  std::vector<std::string> hosts;   // empty: loopback
  std::string advertise;
  std::string token;
  bool weak_token = false;            // may be short
  bool token_for_all = false;         // also programs of this machine need it
  std::string yarp_server;            // HOST:PORT; empty: our own name server
  std::string yarp_dialect = "auto";  // of readers: "3", "4", or each is asked
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
  std::optional<int> with_process;  // the daemon ends with it
  std::vector<std::string> scenario_folders;
  bool strict = false;       // a mesh that is not there is an error
  std::string command_line;  // as given; a recording says it
};

/// Runs the daemon until something ends it. Returns the exit code.
int Serve(ServeOptions options);

/// Threads that share out a step: more than there are cores would only take turns; the results are the same.
int ThreadsOf(const ServeOptions& options);
/// RUN and TIME of RUN@TIME, split at the last @; two empty texts if either is missing.
std::pair<std::string, std::string> SplitMoment(const std::string& from);
ControllerOptions ControllersOf(const ServeOptions& options);
bool IsLoopback(const std::string& host);
/// Whether others than this machine can reach the daemon.
bool BeyondLoopback(const ServeOptions& options);
/// Ports from --port on that belong to names, page and modules: so many, unless modules take any free one.
inline constexpr int kOwnPorts = 2000;
bool IsOwnPort(const ServeOptions& options, int port);

/// Folders to look for files in: the given ones, COOPDYN_PATH, then the data beside the program; of models'
/// files also those of AddModelFolders().
SearchPath DataPath(const std::vector<std::string>& given);
/// Where the environment says that Gazebo and ROS have models, and where Gazebo keeps what it has fetched.
void AddModelFolders(SearchPath& path);

inline constexpr const char* kStrictHelp =
    "In files of other programs, too, what is named and is not there is an error: a mesh that collides, an "
    "<include> of a world";

inline constexpr const char* kVersion = "0.1.0";

}  // namespace coopdyn
