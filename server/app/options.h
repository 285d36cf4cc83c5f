// SPDX-License-Identifier: MIT
// The command line, as values. Flags override COOPDYN_* variables, which override the config file.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/controllers/controller_set.h"
#include "server/physics/stepper.h"
#include "server/record/recorded_step.h"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace coopdyn {

/// What is recorded, and where.
struct RecordOptions {
  std::string file;                // from the start; empty: not
  std::string folder = ".";        // of recordings that are started later
  std::optional<RecordWhat> what;  // empty: as many robots there are
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
  std::string from;                          // RUN@TIME, instead of the scenario
  PlayRun play;                              // instead of both
  RecordOptions record;
  RunOptions run;
  int port = 10000;
  std::optional<int> name_port, http_port;
  std::vector<std::string> hosts;  // empty: loopback
  std::string advertise;
  std::string token;
  bool weak_token = false;  // may be short
  std::string yarp_server;  // HOST:PORT; empty: our own name server
  bool private_robots = false;
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
  std::vector<std::string> scenario_folders;
  std::string command_line;  // as given; a recording says it
};

struct CheckOptions {
  std::vector<std::string> files;
  std::string picture;
  std::vector<std::string> scenario_folders;
};

/// A command that talks to a running daemon.
struct RemoteOptions {
  std::string server;  // HOST[:PORT]; empty: this machine, port 10000
  std::string token;
  std::string verb;                // list, status, run, …, call
  std::vector<std::string> words;  // what follows the verb
};

/// Threads that share out a step: more than there are cores would only take turns; the results are the same.
int ThreadsOf(const ServeOptions& options);
ControllerOptions ControllersOf(const ServeOptions& options);
bool IsLoopback(const std::string& host);
/// Whether others than this machine can reach the daemon.
bool BeyondLoopback(const ServeOptions& options);

/// What the command line asks for.
struct CommandLine {
  enum class Action { kServe, kCheck, kRemote, kDoctor, kOther, kExit };
  Action action = Action::kExit;
  int exit_code = 0;  // of kExit: help was printed, or the use was wrong
  ServeOptions serve;
  CheckOptions check;
  RemoteOptions remote;
  std::function<int()> other;  // of kOther: does it and returns the exit code
};

/// Parses the arguments; prints help to stdout and one line about wrong use to stderr by itself.
CommandLine ParseCommandLine(int argc, const char* const* argv);

/// What is wrong with the words of `app` or of its command, and what to write instead.
std::string Explained(const CLI::App& app, const CLI::ParseError& error);

/// Folders to look for files in: the given ones, COOPDYN_PATH, then the data beside the program.
std::vector<std::string> DataFolders(const std::vector<std::string>& given);

inline constexpr const char* kVersion = "0.1.0";

}  // namespace coopdyn
