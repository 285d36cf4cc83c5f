// SPDX-License-Identifier: MIT
#include "server/app/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "server/app/more_commands.h"

namespace coopdyn {

namespace {

constexpr int kWrongUse = 2;

std::string CheckStep(const std::string& text) {
  double step_s = 0;
  if (!CLI::detail::lexical_cast(text, step_s)) return "--step takes seconds, e.g. --step 0.01, not " + text;
  const double step_us = step_s * 1e6;
  if (!(step_s >= 0.0005 && step_s <= 0.1) || std::abs(step_us - std::round(step_us)) > 1e-6) {
    return "--step must be from 0.0005 to 0.1 s in whole microseconds, e.g. --step 0.01, not " + text;
  }
  return {};
}

std::string CheckPositive(const std::string& text) {
  double value = 0;
  if (!CLI::detail::lexical_cast(text, value) || !(value > 0) || !std::isfinite(value)) {
    return "must be a number above 0, not " + text;
  }
  return {};
}

std::string CheckFinite(const std::string& text) {
  double value = 0;
  if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value))
    return "must be a finite number, not " + text;
  return {};
}

std::string CheckSeed(const std::string& text) {
  const bool digits =
      !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  return digits ? "" : "--seed must be a whole number from 0, not " + text;
}

std::string CheckToken(const std::string& text) {
  return text.find_first_of(" \t\r\n") == std::string::npos
             ? ""
             : "--token must be one word: hello NAME TOKEN is split at blanks";
}

/// The raw values CLI11 fills before they are turned into options.
struct Raw {
  std::string mode, controllers;
  double step_s = 0;
  double speed = 0;
  std::uint64_t seed = 0;
  double duration_s = 0;
  int name_port = 0, http_port = 0, robot_threads = 0, spin_us = 0;
  std::string config;  // read before the arguments are: InsertConfig()
};

void AddServe(CLI::App& app, ServeOptions& serve, Raw& raw) {
  CLI::App* sub = app.add_subcommand("serve", "Run a scenario and serve its robots");
  sub->footer("Example: coopdyn serve classroom --mode lockstep --port 10000");
  sub->add_option("scenario", serve.scenario, "A .scenario or .world file, or a bare name on the search path")
      ->capture_default_str();
  sub->add_option("--mode", raw.mode, "realtime, lockstep or free")
      ->check(CLI::IsMember({"realtime", "lockstep", "free"}))
      ->envname("COOPDYN_MODE");
  sub->add_option("--step", raw.step_s, "Step in seconds, 0.0005 to 0.1")
      ->check(CLI::Validator(CheckStep, ""))
      ->envname("COOPDYN_STEP");
  sub->add_option("--speed", raw.speed, "Times the wall clock; 0 or less: no limit")
      ->check(CLI::Validator(CheckFinite, ""))
      ->envname("COOPDYN_SPEED");
  sub->add_option("--seed", raw.seed, "Of noise and solver")
      ->check(CLI::Validator(CheckSeed, ""))
      ->envname("COOPDYN_SEED");
  sub->add_option("--duration", raw.duration_s, "End the run at this simulated time, s")
      ->check(CLI::Validator(CheckPositive, ""))
      ->envname("COOPDYN_DURATION");
  sub->add_flag("--paused", serve.run.paused, "Start paused")->envname("COOPDYN_PAUSED");
  sub->add_option("--port", serve.port, "Names on P, page on P+1, modules from P+2; 0: any free ports")
      ->check(CLI::Range(0, 65000))
      ->envname("COOPDYN_PORT")
      ->capture_default_str();
  sub->add_option("--name-port", raw.name_port, "Another port for the name server")
      ->check(CLI::Range(0, 65535))
      ->envname("COOPDYN_NAME_PORT");
  sub->add_option("--http-port", raw.http_port, "Another port for the page")
      ->check(CLI::Range(0, 65535))
      ->envname("COOPDYN_HTTP_PORT");
  sub->add_option("--host", serve.hosts,
                  "Address to listen at (default: this machine only); 0.0.0.0: everybody")
      ->envname("COOPDYN_HOST");
  sub->add_option("--advertise", serve.advertise, "Address that the name server tells")
      ->envname("COOPDYN_ADVERTISE");
  sub->add_option("--token", serve.token, "What changing commands from other machines must show")
      ->check(CLI::Validator(CheckToken, ""))
      ->envname("COOPDYN_TOKEN");
  sub->add_flag("--private", serve.private_robots, "Robots' modules need the token too")
      ->envname("COOPDYN_PRIVATE");
  sub->add_option("--yarp-server", serve.yarp_server, "Register the names at this name server, HOST:PORT")
      ->envname("COOPDYN_YARP_SERVER");
  sub->add_flag("--no-render", serve.no_render, "No pictures")->envname("COOPDYN_NO_RENDER");
  sub->add_flag("--no-http", serve.no_http, "No page")->envname("COOPDYN_NO_HTTP");
  sub->add_flag("--no-net", serve.no_net, "No sockets at all")->envname("COOPDYN_NO_NET");
  sub->add_option("--render-fps", serve.render_fps, "Pictures per second of the live view")
      ->check(CLI::Range(0.1, 60.0))
      ->envname("COOPDYN_RENDER_FPS")
      ->capture_default_str();
  sub->add_option("--renderer", serve.renderer, "auto, osmesa or egl")
      ->check(CLI::IsMember({"auto", "osmesa", "egl"}))
      ->envname("COOPDYN_RENDERER")
      ->capture_default_str();
  sub->add_option("--robot-threads", raw.robot_threads,
                  "Threads for the robots' connections (default: one each on many cores, else 1 or 2)")
      ->check(CLI::Range(1, 10000))
      ->envname("COOPDYN_ROBOT_THREADS");
  sub->add_option(
         "--threads", serve.threads,
         "Threads that share out sensing, controllers and physics, at most one a core; worth it from some "
         "hundred robots on; the results stay the same")
      ->check(CLI::Range(1, 256))
      ->envname("COOPDYN_THREADS")
      ->capture_default_str();
  sub->add_option(
         "--controllers", raw.controllers,
         "Where loaded controllers run: child (a process of their own) or in-process (for a debugger)")
      ->check(CLI::IsMember({"child", "in-process"}))
      ->envname("COOPDYN_CONTROLLERS");
  sub->add_option("--spin", raw.spin_us, "Poll this many microseconds before sleeping")
      ->check(CLI::Range(0, 1000000))
      ->envname("COOPDYN_SPIN");
  sub->add_option("--log-level", serve.log_level, "debug, info, warning, error or off")
      ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}))
      ->envname("COOPDYN_LOG_LEVEL")
      ->capture_default_str();
  sub->add_option("--summary", serve.summary_file, "Write a summary of the run to this file (JSON)")
      ->envname("COOPDYN_SUMMARY");
  sub->add_option("--scenarios", serve.scenario_folders, "A folder with scenarios, worlds and robots");
  sub->set_config("--config", "", "Read options from this file (name=value lines)")
      ->envname("COOPDYN_CONFIG");
}

/// Says which commands there are if the first argument is none.
void CheckCommand(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (!arguments.empty() && arguments[0].starts_with("-")) return;
  std::string commands;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!arguments.empty() && sub->get_name() == arguments[0]) return;
    if (sub->get_group().empty()) continue;  // hidden
    commands += (commands.empty() ? "" : ", ") + sub->get_name();
  }
  const std::string what = arguments.empty() ? "a command is missing" : "there is no command " + arguments[0];
  throw CLI::ParseError(what + ": write one of " + commands, CLI::ExitCodes::InvalidError);
}

/// Adds the lines of the config file to `arguments` (the program's name not among them), but for options that
/// the command line or a variable gives.
void InsertConfig(CLI::App& app, std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments.front() != "serve") return;
  const CLI::App& serve = *app.get_subcommand("serve");
  const auto given = [&arguments](const std::string& flag) {
    return std::find_if(arguments.begin(), arguments.end(), [&flag](const std::string& argument) {
      return argument == flag || argument.starts_with(flag + "=");
    });
  };
  std::string file;
  if (const auto flag = given("--config"); flag != arguments.end()) {
    const std::size_t equals = flag->find('=');
    if (equals != std::string::npos) {
      file = flag->substr(equals + 1);
    } else if (std::next(flag) != arguments.end()) {
      file = *std::next(flag);
    }
  } else if (const char* variable = std::getenv("COOPDYN_CONFIG")) {
    file = variable;
  }
  if (file.empty()) return;
  std::ifstream stream(file);
  if (!stream) throw CLI::FileError(file + " cannot be read", CLI::ExitCodes::FileError);
  std::vector<std::string> added;
  for (const CLI::ConfigItem& item : CLI::ConfigINI().from_config(stream)) {
    const std::string flag = "--" + item.name;
    const CLI::Option* option = serve.get_option_no_throw(flag);
    if (option == nullptr || item.inputs.empty() || !item.parents.empty() || flag == "--config") {
      throw CLI::ParseError(
          file + ": there is no option " + item.fullname() + " (coopdyn serve --help lists them)",
          CLI::ExitCodes::ConfigError);
    }
    if (given(flag) != arguments.end()) continue;
    if (!option->get_envname().empty() && std::getenv(option->get_envname().c_str()) != nullptr) continue;
    for (const std::string& input : item.inputs) {
      const bool is_flag = option->get_items_expected_max() == 0;
      if (!is_flag) added.push_back(flag + "=" + input);
      if (is_flag && input == "true") added.push_back(flag);
    }
  }
  arguments.insert(arguments.begin() + 1, added.begin(), added.end());
}

void TakeRaw(const CLI::App& sub, const Raw& raw, ServeOptions& serve) {
  const auto given = [&sub](const char* name) { return sub.get_option(name)->count() > 0; };
  if (given("--mode")) serve.run.mode = ParseMode(raw.mode);
  serve.controllers_in_process = raw.controllers == "in-process";
  if (given("--step")) serve.run.step = std::llround(raw.step_s * 1e6) * 1000;
  if (given("--speed")) serve.run.speed = raw.speed;
  if (given("--seed")) serve.run.seed = raw.seed;
  if (given("--duration")) serve.run.duration_s = raw.duration_s;
  if (given("--name-port")) serve.name_port = raw.name_port;
  if (given("--http-port")) serve.http_port = raw.http_port;
  if (given("--robot-threads")) serve.robot_threads = raw.robot_threads;
  if (given("--spin")) serve.spin_us = raw.spin_us;
}

struct Verb {
  const char* name;
  const char* help;
  const char* example;
  int min_words, max_words;
};

// Commands that talk to a running daemon; what they do is in remote.cc.
constexpr Verb kVerbs[] = {
    {"list", "List the names of all modules", "coopdyn list", 0, 0},
    {"status", "How the run stands", "coopdyn status", 0, 0},
    {"run", "Let the run go on", "coopdyn run", 0, 0},
    {"pause", "Pause the run", "coopdyn pause", 0, 0},
    {"step", "Run N steps while paused", "coopdyn step 10", 0, 1},
    {"reset", "Back to the start, with another seed if given", "coopdyn reset 7", 0, 1},
    {"reload", "Read the scenario's file again", "coopdyn reload", 0, 0},
    {"load", "Load another scenario: a bare name, or a file of this machine", "coopdyn load corridor", 1, 1},
    {"stop-all", "Stop all robots", "coopdyn stop-all", 0, 0},
    {"quit", "End the daemon", "coopdyn quit", 0, 0},
    {"call", "Send any command to any module",
     "coopdyn call /robot1/motors set_velocity 0.2 0.5    coopdyn call /robot1/target get_target \"red\"", 2,
     1 << 20},
};

void AddRemote(CLI::App& app, RemoteOptions& remote) {
  const auto common = [&remote](CLI::App* sub) {
    // Not CLI11's envname: it would apply the variable once more for each command that is not given.
    sub->add_option("--server", remote.server,
                    "HOST[:PORT] of the daemon (default: COOPDYN_SERVER, else this machine, port 10000)");
    sub->add_option("--token", remote.token,
                    "The daemon's token, from another machine (default: COOPDYN_TOKEN)");
  };
  for (const Verb& verb : kVerbs) {
    CLI::App* sub = app.add_subcommand(verb.name, verb.help);
    sub->footer(std::string("Example: ") + verb.example);
    common(sub);
    if (verb.max_words > 0) {
      // Numbers may be negative: what is not an option of ours is a word.
      sub->allow_extras();
      sub->positionals_at_end(false);
    }
    sub->callback([&remote, sub, &verb] {
      remote.verb = verb.name;
      remote.words = sub->remaining();
      const auto count = static_cast<int>(remote.words.size());
      if (count < verb.min_words || count > verb.max_words) {
        throw CLI::ValidationError(std::string("write e.g. ") + verb.example);
      }
    });
  }
  CLI::App* doctor = app.add_subcommand("doctor", "Find out why a client cannot connect");
  doctor->footer("Example: coopdyn doctor --server labserver:10000");
  common(doctor);
}

}  // namespace

CommandLine ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  Raw raw;
  CLI::App app{"coopdyn, a multi-robot simulator daemon"};
  app.name("coopdyn");
  app.set_version_flag("--version", std::string("coopdyn ") + kVersion);
  app.require_subcommand(1);
  app.footer("Example: coopdyn serve classroom");
  AddServe(app, line.serve, raw);

  CLI::App* check = app.add_subcommand("check", "Say what is wrong in worlds, scenarios and robot models");
  check->footer("Example: coopdyn check my.scenario --picture my.png");
  check->add_option("file", line.check.files, "Files, or bare names on the search path")->required();
  check->add_option("--picture", line.check.picture, "Write a picture of the (last) scenario, PNG");
  check->add_option("--scenarios", line.check.scenario_folders, "A folder with scenarios, worlds and robots");

  AddRemote(app, line.remote);
  AddMoreCommands(app, line.other);

  try {
    std::vector<std::string> arguments(argv + 1, argv + argc);
    CheckCommand(app, arguments);
    InsertConfig(app, arguments);
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
    app.parse(std::move(arguments));
  } catch (const CLI::Success& success) {  // --help, --version
    line.exit_code = app.exit(success);
    return line;
  } catch (const CLI::ParseError& error) {
    std::cerr << "coopdyn: " << error.what() << " (coopdyn --help shows the commands)\n";
    line.exit_code = kWrongUse;
    return line;
  }
  const auto variable = [](const char* name, std::string& value) {
    const char* given = value.empty() ? std::getenv(name) : nullptr;
    if (given != nullptr) value = given;
  };
  variable("COOPDYN_SERVER", line.remote.server);
  variable("COOPDYN_TOKEN", line.remote.token);
  const CLI::App* sub = app.get_subcommands().front();
  if (sub->get_name() == "serve") {
    TakeRaw(*sub, raw, line.serve);
    line.action = CommandLine::Action::kServe;
  } else if (sub->get_name() == "check") {
    line.action = CommandLine::Action::kCheck;
  } else if (sub->get_name() == "doctor") {
    line.action = CommandLine::Action::kDoctor;
  } else if (line.other) {
    line.action = CommandLine::Action::kOther;
  } else {
    line.action = CommandLine::Action::kRemote;
  }
  return line;
}

std::vector<std::string> DataFolders(const std::vector<std::string>& given) {
  std::vector<std::string> folders = given;
  if (const char* path = std::getenv("COOPDYN_PATH")) {
    std::istringstream stream(path);
    for (std::string folder; std::getline(stream, folder, ':');) {
      if (!folder.empty()) folders.push_back(folder);
    }
  }
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  // Controllers that were built with the program.
  if (std::filesystem::is_directory(program / "controllers", error)) folders.push_back(program.string());
  // Installed (bin/ beside share/), or in the build tree (build/<preset>/).
  for (const char* relative : {"../share/coopdyn", "../.."}) {
    const std::filesystem::path folder = std::filesystem::weakly_canonical(program / relative, error);
    if (std::filesystem::is_directory(folder / "robots", error)) folders.push_back(folder.string());
  }
  return folders;
}

}  // namespace coopdyn
