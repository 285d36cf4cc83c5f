// SPDX-License-Identifier: MIT
#include "server/app/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "server/app/more_commands.h"
#include "server/app/print.h"
#include "server/app/serve_options.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

constexpr int kWrongUse = 2;

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
    {"load", "Load another scenario: a bare name, a file of this machine, or - (standard input)",
     "coopdyn load corridor", 1, 1},
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

std::string Explained(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const CLI::App& command = chosen.empty() ? app : *chosen.back();
  const std::string said = error.what();  // of an option: "--port: …", "run is required"
  std::string what = said;
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    const std::string word = app.remaining(true).at(0);
    what = word + " is one word too many";
    if (word.starts_with("--")) {
      std::vector<std::string> flags;
      for (const CLI::Option* option : command.get_options()) flags.push_back(option->get_name());
      const std::string nearest = Nearest(word.substr(0, word.find('=')), flags);
      what = "there is no option " + word + (nearest.empty() ? "" : ": did you mean " + nearest + "?");
    }
  } else if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const bool missing = said.find("missing") != std::string::npos;
    what = said.substr(0, said.find(':')) + (missing ? " needs a value" : " may be given once");
  } else if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !chosen.empty()) {
    std::string name = said.substr(0, said.find(' '));
    std::transform(name.begin(), name.end(), name.begin(), ::toupper);
    what = name + " is missing";
  } else if (chosen.empty()) {
    return what + " (" + app.get_name() + " --help shows the commands)";
  }
  return what + " (" + app.get_name() + (chosen.empty() ? "" : " " + command.get_name()) +
         " --help shows how to write it)";
}

CommandLine ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  RawServe raw, raw_play;
  ServeOptions play;
  CLI::App app{"coopdyn, a multi-robot simulator daemon"};
  app.name("coopdyn");
  app.set_version_flag("--version", std::string("coopdyn ") + kVersion);
  app.require_subcommand(1);
  app.footer("Example: coopdyn serve classroom");
  AddServe(app, line.serve, raw);
  AddPlay(app, play, raw_play);

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
    PrintError("coopdyn: {}\n", Explained(app, error));
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
  if (sub->get_name() == "serve" || sub->get_name() == "play") {
    const bool plays = sub->get_name() == "play";
    if (plays) line.serve = std::move(play);
    try {
      TakeRaw(*sub, plays ? raw_play : raw, line.serve);
    } catch (const CLI::ValidationError& error) {
      PrintError("coopdyn: {}\n", error.what());
      line.exit_code = kWrongUse;
      return line;
    }
    for (int i = 0; i < argc; ++i) line.serve.command_line += (i > 0 ? " " : "") + std::string(argv[i]);
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
