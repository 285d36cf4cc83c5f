// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <set>
#include <system_error>

#include "protocol/codec.h"
#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/model/section_reader.h"
#include "server/naming/yarp_conf.h"
#include "server/record/player.h"
#include "server/replay/export_file.h"

namespace coopdyn {

namespace {

std::string CheckStep(const std::string& text) {
  double step_s = 0;
  if (!CLI::detail::lexical_cast(text, step_s)) return "--step takes seconds, e.g. --step 0.01, not " + text;
  const double step_us = step_s * 1e6;
  if (!(step_s >= 0.0005 && step_s <= 0.1) || std::abs(step_us - std::round(step_us)) > 1e-6) {
    return "--step must be from 0.0005 to 0.1 s in whole microseconds, e.g. --step 0.01, not " + text;
  }
  return {};
}

std::string CheckSeed(const std::string& text) {
  const bool digits =
      !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  return digits ? "" : "--seed must be a whole number from 0, not " + text;
}

/// Replaces `yarp.conf` by the server that the file names.
std::string TakeYarpServer(std::string& text) {
  if (text != "yarp.conf") return {};
  const std::string name = YarpConfFile([](const char* variable) {
    const char* const value = std::getenv(variable);
    return std::string(value == nullptr ? "" : value);
  });
  std::ifstream file(name);
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  const std::string server = ServerInYarpConf(content);
  if (server.empty()) return name + " names no server: write HOST:PORT, or run yarp conf HOST PORT";
  text = server;
  return {};
}

std::string CheckToken(const std::string& text) {
  return text.find_first_of(" \t\r\n") == std::string::npos
             ? ""
             : "--token must be one word: hello NAME TOKEN is split at blanks";
}

std::string CheckPlaySpeed(const std::string& text) {
  double value = 0;
  return CLI::detail::lexical_cast(text, value) && IsPlaySpeed(value) ? "" : "--speed " + text + kNoPlaySpeed;
}

/// Makes the folder if it is missing.
void MakeRecordingsFolder(const std::string& folder) {
  if (folder.empty()) throw CLI::ValidationError("--recordings takes a folder, e.g. --recordings runs");
  std::error_code failed, ignored;
  const bool there = std::filesystem::exists(folder, ignored);
  if (!there) std::filesystem::create_directories(folder, failed);
  if (std::filesystem::is_directory(folder, ignored)) return;
  const std::string why = there ? "is no folder" : "cannot be made (" + failed.message() + ")";
  throw CLI::ValidationError("--recordings " + folder + " " + why +
                             ": write a folder that you may write to, e.g. --recordings runs");
}

/// Throws if `file` cannot be written. Changes or makes no file.
void CheckWritable(const std::string& option, const std::string& file, const std::string& example) {
  if (file.empty()) return;
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    throw CLI::ValidationError(option + " " + file + " is a folder: write a file, e.g. " + option + " " +
                               example);
  }
  if (!CheckFree(file, true).empty()) {
    throw CLI::ValidationError(
        option + " " + file +
        " is a scenario, a world, a model or a recording, which is never replaced: write "
        "another file, e.g. " +
        option + " " + example);
  }
  // The summary is written beside the file and renamed.
  const std::filesystem::path folder = std::filesystem::weakly_canonical(file, ignored).parent_path();
  const std::string written = std::filesystem::is_other(file, ignored) ? file : folder.string() + "/";
  if (::access(written.c_str(), W_OK) == 0) return;
  throw CLI::ValidationError(option + " " + file + " cannot be written (" +
                             std::generic_category().message(errno) + ")");
}

void CheckFolderOf(const std::string& option, const std::string& file) {
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  if (folder.empty() || std::filesystem::is_directory(folder, ignored)) return;
  throw CLI::ValidationError(option + " " + file + " cannot be made: there is no folder " + folder.string() +
                             ": make it, or name a file in another");
}

RecordWhat ReadRecordWhat(const std::string& given) {
  std::string unknown;
  if (const auto what = ParseRecordWhat(given, unknown)) return *what;
  throw CLI::ValidationError("--record-what knows no '" + unknown +
                             "': write some of poses,channels,distances,targets,controllers,images, or all");
}

/// Lets environment variables set all options except those in `only_flags`: COOPDYN_ROBOT_THREADS sets
/// --robot-threads. COOPDYN_SEAT is a student's seat and PIN, for programs.
void TakeVariables(CLI::App* sub, const std::set<std::string>& only_flags) {
  for (CLI::Option* option : sub->get_options()) {
    if (option->get_lnames().empty() || only_flags.contains(option->get_lnames().front())) continue;
    std::string variable = CLI::detail::find_and_replace(option->get_lnames().front(), "-", "_");
    std::transform(variable.begin(), variable.end(), variable.begin(), ::toupper);
    option->envname("COOPDYN_" + variable);
  }
}

void AddStopOrContinue(CLI::App* sub, const std::string& name, bool& stop, const std::string& help) {
  sub->add_option_function<std::string>(
         name, [&stop](const std::string& given) { stop = given == "stop"; }, help)
      ->check(OneOf({"continue", "stop"}));
}

/// Options of the network, the page and pictures.
void AddNetwork(CLI::App* sub, ServeOptions& serve) {
  sub->add_option("--port", serve.port, "Names on P, page on P+1, modules from P+2; 0: any free ports")
      ->check(WholeIn(0, 65000))
      ->capture_default_str();
  sub->add_flag("--any-port", serve.any_port,
                "Other free ports for names and page if theirs are in use, and any for the modules");
  sub->add_option("--name-port", serve.name_port, "Another port for the name server")
      ->check(WholeIn(0, 65535));
  sub->add_option("--http-port", serve.http_port, "Another port for the page")->check(WholeIn(0, 65535));
  sub->add_option("--channel-port", serve.channel_port,
                  "First port for clients of YARS (default: 4500, or any with --port 0)")
      ->check(WholeIn(0, 65535));
  sub->add_option("--host", serve.hosts,
                  "Address to listen at (default: this machine only); 0.0.0.0: everybody");
  sub->add_option("--advertise", serve.advertise, "Address that the name server reports");
  sub->add_option("--token", serve.token,
                  "Token that commands from other machines must present to change the world")
      ->check(CLI::Validator(CheckToken, ""));
  sub->add_flag("--weak-token", serve.weak_token, "Let --token be shorter than 12 characters");
  // Without a group they do not stand in --help: for `coopdyn host`.
  sub->add_option("--seat", serve.seat, "Take connections from coopdyn host at this socket, and no others")
      ->group("");
  sub->add_flag("--seat-ports", serve.seat_ports, "Besides, ports for machines that coopdyn host admits")
      ->group("");
  sub->add_option("--seat-url", serve.seat_url, "The address of the page, as the host shows it")->group("");
  sub->add_flag(
      "--token-for-all", serve.token_for_all,
      "Programs of this machine need the token, too; without it they may only drive robots and read");
  sub->add_flag("--private", serve.private_robots, "Robots' modules need the token too");
  sub->add_flag("--read-only", serve.read_only, "Clients and the page may only read and watch");
  sub->add_option("--yarp-server", serve.yarp_server,
                  "Register the names at this name server, HOST:PORT, or at that of yarp.conf")
      ->transform(CLI::Validator(TakeYarpServer, ""));
  sub->add_option("--yarp-dialect", serve.yarp_dialect,
                  "Numbers as programs of YARP 3 or 4 read them; auto: ask each")
      ->check(OneOf({"auto", "3", "4"}))
      ->capture_default_str();
  sub->add_option("--channel-ports-to", serve.channel_ports_file,
                  "Write the port of each of these robots into a file BASE-ROBOT");
  sub->add_flag("--channel-quits", serve.channel_quits, "Clients of YARS may end the daemon");
  sub->add_flag("--no-render", serve.no_render, "No pictures");
  sub->add_flag("--no-http", serve.no_http, "No page");
  sub->add_option("--render-fps", serve.render_fps, "Pictures per second of the live view")
      ->check(NumberIn(0.1, 60))
      ->capture_default_str();
  sub->add_option("--renderer", serve.renderer, "auto, osmesa or egl")
      ->check(OneOf({"auto", "osmesa", "egl"}))
      ->capture_default_str();
  sub->add_option(
         "--robot-threads", serve.robot_threads,
         "Threads for the robots' connections (default: one each for up to 64 robots with sockets; more "
         "robots, and those without, share 1 or 2)")
      ->check(WholeIn(1, 10000));
  sub->add_option("--spin", serve.spin_us, "Poll this many microseconds before sleeping")
      ->check(WholeIn(0, 1000000));
  sub->add_option("--log-level", serve.log_level, "debug, info, warning, error or off")
      ->check(OneOf({"debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
  sub->add_option("--log-file", serve.log_file, "Add the lines of the log to this file too");
  sub->add_option("--scenarios", serve.scenario_folders, "A folder with scenarios, worlds and robots");
}

void AddRecording(CLI::App* sub, ServeOptions& serve) {
  sub->add_option("--record", serve.record.file, "Record the run in this file, e.g. lesson1.run");
  sub->add_option_function<std::string>(
      "--record-what", [&serve](const std::string& given) { serve.record.what = ReadRecordWhat(given); },
      "Besides poses and commands: channels, distances, targets, controllers, images (with commas), all (but "
      "images), or "
      "poses (default: all up to 50 robots, beyond that poses,controllers)");
  sub->add_option_function<double>(
         "--record-every", [&serve](double given_s) { serve.record.every = std::llround(given_s * 1e9); },
         "Seconds between recorded poses and readings (commands and hashes are recorded with each step)")
      ->check(NumberIn(0, kMaxDuration_s, true));
  sub->add_flag(
      "--record-durable", serve.record.durable,
      "Answer a step in lockstep and free mode only when the disk has it: neither a crash nor a power "
      "cut loses it, and steps take as long as the disk");
  sub->add_flag("--force", serve.record.force,
                "Replace the recording that --record names; record though the disk is too small");
  AddStopOrContinue(sub, "--on-record-failure", serve.record.stop_on_failure,
                    "What to do when the recording fails, e.g. on a full disk: continue or stop");
  sub->add_option("--recordings", serve.record.folder,
                  "Folder of recordings that are started later, and of those that clients may list and copy; "
                  "made if there is none")
      ->capture_default_str();
}

/// Throws if the token is short enough to be guessed by other machines.
void CheckStrength(const ServeOptions& serve) {
  constexpr std::size_t kStrongToken = 12;
  const std::size_t characters = CharacterCount(serve.token);
  if (!serve.token.empty() && characters < kStrongToken && !serve.weak_token && !serve.no_net &&
      BeyondLoopback(serve)) {
    throw CLI::ValidationError(
        fmt::format("--token has {} characters, and with --host others can try tokens: write at least {}, or "
                    "leave --token out (one is made and printed), or add --weak-token",
                    characters, kStrongToken));
  }
}

/// Throws if --channel-port would take a port of a module or of the page.
void CheckChannelPort(const ServeOptions& serve) {
  if (!serve.channel_port || serve.no_net || !IsOwnPort(serve, *serve.channel_port)) return;
  throw CLI::ValidationError(fmt::format(
      "--channel-port {} is one of the daemon's own: names, page and modules have {} to {}, or what "
      "--name-port and --http-port say; write another one, e.g. --channel-port {}",
      *serve.channel_port, serve.port, serve.port + kOwnPorts - 1,
      serve.port > kOwnPorts ? serve.port - 100 : serve.port + kOwnPorts));
}

/// Throws if options contradict each other or files cannot be written.
void CheckServe(const CLI::App& sub, const ServeOptions& serve) {
  if (sub.count("--record") > 0 && serve.record.file.empty()) {
    throw CLI::ValidationError("--record takes the name of a file, e.g. --record lesson1.run");
  }
  CheckFolderOf("--record", serve.record.file);
  if (!serve.from.empty()) {
    if (SplitMoment(serve.from).first.empty()) {
      throw CLI::ValidationError(
          "--from takes a recording and a time in seconds: --from lesson1.run@12.5, or lesson1.run@end");
    }
    if (serve.run.seed) {
      throw CLI::ValidationError("--from uses the seed of the recording: leave --seed out");
    }
    if (!serve.settings.empty()) {
      throw CLI::ValidationError("--from continues with the scenario of the recording: leave --set out");
    }
    if (sub.count("scenario") > 0) {
      throw CLI::ValidationError("--from uses the scenario of the recording: leave " + serve.scenario +
                                 " out");
    }
  }
  CheckStrength(serve);
  CheckChannelPort(serve);
  if (sub.count("--recordings") > 0)
    MakeRecordingsFolder(serve.record.folder);  // only after all other checks
  // These files may be in that folder.
  CheckWritable("--summary", serve.summary_file, "run.json");
  CheckWritable("--log-file", serve.log_file, "night.log");
}

void AddPlay(CLI::App& app, const std::string& command_line, Chosen& chosen) {
  const auto given = std::make_shared<ServeOptions>();
  ServeOptions& serve = *given;
  serve.command_line = command_line;
  CLI::App* sub = app.add_subcommand("play", "Play a recording: its robots, pictures and page as in the run");
  sub->footer("Example: coopdyn play lesson1.run --speed 2 --at 12.5");
  sub->add_option("run", serve.play.file, "A recording, e.g. lesson1.run")->required();
  sub->add_option("--speed", serve.play.speed, "Multiple of real time, -4 to 64; negative: backwards")
      ->check(CLI::Validator(CheckPlaySpeed, ""));
  sub->add_option_function<double>(
         "--at", [&serve](double given_s) { serve.play.start = std::llround(given_s * 1e9); },
         "Begin at this simulated time, s (default: the start)")
      ->check(NumberIn(-kMaxDuration_s, kMaxDuration_s));
  sub->add_flag("--loop", serve.play.loop, "Start again at the end");
  sub->add_flag("--paused", serve.play.paused, "Start paused at the first frame");
  AddNetwork(sub, serve);
  TakeVariables(sub,
                {"help", "scenarios", "speed", "at", "loop", "paused", "seat", "seat-ports", "seat-url"});
  sub->callback([given, &chosen] {
    CheckStrength(*given);
    CheckChannelPort(*given);
    CheckWritable("--log-file", given->log_file, "night.log");
    chosen = [given] { return Serve(*given); };
  });
}

}  // namespace

void AddSettings(CLI::App* sub, Settings& settings) {
  sub->add_option("--set", settings,
                  "Give a key of the scenario another value: SECTION.key=value; may be repeated")
      ->allow_extra_args(false);
}

std::pair<std::string, std::string> SplitMoment(const std::string& from) {
  const std::size_t at = from.rfind('@');
  if (at == std::string::npos || at == 0 || at + 1 == from.size()) return {};
  return {from.substr(0, at), from.substr(at + 1)};
}

void AddServe(CLI::App& app, const std::string& command_line, Chosen& chosen) {
  const auto given = std::make_shared<ServeOptions>();
  ServeOptions& serve = *given;
  serve.command_line = command_line;
  CLI::App* sub = app.add_subcommand("serve", "Run a scenario and serve its robots");
  sub->footer(
      "Example: coopdyn serve classroom --mode lockstep --port 10000\n"
      "Exit codes: 0 ok; 1 errors; 2 wrong use; 4 a controller failed, a body was frozen or the recording\n"
      "failed; 5 a signal or quit came before --duration.\n"
      "A run that its scenario ends stands until it is reset; with --duration, --steps, --summary or\n"
      "--no-net the program ends with it. SIGTERM, SIGINT and SIGHUP end the run in order;\n"
      "SIGUSR1 logs the current state, writes --summary and continues.");
  sub->add_option("scenario", serve.scenario,
                  "A .scenario, .world, .sdf, .urdf or .xml file, a bare name on the search path, or - "
                  "(standard input)")
      ->capture_default_str();
  sub->add_option_function<std::string>(
         "--mode", [&serve](const std::string& word) { serve.run.mode = ParseMode(word); },
         "realtime, lockstep or free")
      ->check(OneOf({"realtime", "lockstep", "free"}));
  sub->add_option_function<double>(
         "--step", [&serve](double step_s) { serve.run.step = std::llround(step_s * 1e6) * 1000; },
         "Step in seconds, 0.0005 to 0.1")
      ->check(CLI::Validator(CheckStep, ""));
  sub->add_option("--speed", serve.run.speed, "Multiple of real time; 0 or less: no limit")
      ->check(NumberIn(-kMaxSpeed, kMaxSpeed));
  sub->add_option("--seed", serve.run.seed, "Of noise and solver")->check(CLI::Validator(CheckSeed, ""));
  CLI::Option* duration =
      sub->add_option("--duration", serve.run.duration_s, "End the run at this simulated time, s")
          ->check(NumberIn(0, kMaxDuration_s, true));
  sub->add_option("--steps", serve.run.steps, "End the run after this step, instead of --duration")
      ->check(WholeIn(1, 1'000'000'000))
      ->excludes(duration);
  AddSettings(sub, serve.settings);
  sub->add_option("--with-process", serve.with_process,
                  "End when the process with this number ends, however it ends")
      ->check(WholeIn(1, std::numeric_limits<int>::max()));
  sub->add_flag("--paused", serve.run.paused, "Start paused");
  sub->add_flag("--no-net", serve.no_net, "No sockets at all");
  sub->add_option("--threads", serve.threads,
                  "Threads for sensing, controllers and physics, at most one per core; useful from some "
                  "hundred robots on; the results stay the same")
      ->check(WholeIn(1, 256))
      ->capture_default_str();
  sub->add_option_function<std::string>(
         "--controllers",
         [&serve](const std::string& where) { serve.controllers_in_process = where == "in-process"; },
         "Where loaded controllers run: child (a process of their own) or in-process (for a debugger)")
      ->check(OneOf({"child", "in-process"}));
  sub->add_option_function<std::uint64_t>(
         "--controller-memory", [&serve](std::uint64_t mib) { serve.controller_memory_bytes = mib << 20; },
         "MiB that all loaded controllers together may use (default: half of this machine's memory; "
         "0: no limit)")
      ->check(WholeIn(0, 1 << 30));
  AddStopOrContinue(
      sub, "--on-controller-failure", serve.run.stop_on_controller_failure,
      "When a loaded controller fails: continue (its robot stands, the run continues) or stop (the "
      "run ends); the exit code is 4 either way (default: continue)");
  sub->add_option(
      "--summary", serve.summary_file,
      "Write a summary of the run to this file (JSON) at its end, and its current state on SIGUSR1");
  sub->add_option("--from", serve.from,
                  "Continue from a moment of a recording instead of a scenario: RUN@SECONDS, RUN@#STEP, "
                  "RUN@start or RUN@end");
  sub->add_flag("--strict", serve.strict, kStrictHelp);
  AddRecording(sub, serve);
  AddNetwork(sub, serve);
  sub->set_config("--config", "", "Read options from this file (name=value lines)");
  TakeVariables(
      sub, {"help", "scenarios", "force", "from", "set", "with-process", "seat", "seat-ports", "seat-url"});
  sub->callback([sub, given, &chosen] {
    CheckServe(*sub, *given);
    RunOptions& run = given->run;
    run.ends_daemon = run.duration_s || run.steps || !given->summary_file.empty() || given->no_net;
    chosen = [given] { return Serve(*given); };
  });
  AddPlay(app, command_line, chosen);
}

}  // namespace coopdyn
