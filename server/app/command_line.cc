// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <vector>

#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/print.h"
#include "server/app/python_programs.h"
#include "server/app/yars_words.h"
#include "server/controllers/child_process.h"
#include "server/model/readers.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

/// Throws with a list of the commands if the first argument is not a command.
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

/// Throws if an option that needs a value is followed by another option.
void CheckValues(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments.front().starts_with("-")) return;
  const CLI::App* command = app.get_subcommand(arguments.front());  // exists: CheckCommand()
  const auto option_of = [command](const std::string& word) {
    return word.starts_with("--") ? command->get_option_no_throw(word) : nullptr;
  };
  for (std::size_t i = 1; i + 1 < arguments.size(); ++i) {
    const CLI::Option* option = option_of(arguments[i]);
    if (option == nullptr || option->get_items_expected_min() == 0 || option_of(arguments[i + 1]) == nullptr)
      continue;
    throw CLI::ArgumentMismatch(arguments[i] + ": 1 required " + option->get_type_name() + " missing",
                                CLI::ExitCodes::ArgumentMismatch);
  }
}

/// Inserts the lines of the config file into `arguments` (without the program's name), except options that
/// the command line or a variable sets.
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
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(file, ignored);
  if (!stream || folder) {
    const std::string why = folder ? "it is a folder" : std::generic_category().message(errno);
    throw CLI::FileError(
        "--config " + file + " cannot be read (" + why + "): name a file with lines port=10100",
        CLI::ExitCodes::FileError);
  }
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

/// Explains a wrong value of an option or word of `command`, from CLI11's message "--port: …".
std::string WrongValue(const CLI::App& command, const std::string& said,
                       const std::vector<std::string>& arguments) {
  const std::size_t colon = said.find(": ");
  std::string name = said.substr(0, colon);
  const std::string what = said.substr(colon + 2);
  const CLI::Option* option = command.get_option_no_throw(name);
  if (option == nullptr) return said;
  if (what.starts_with("--")) return what;  // complete message
  const bool given = std::ranges::any_of(
      arguments, [&](const std::string& word) { return word == name || word.starts_with(name + "="); });
  if (!given && !option->get_envname().empty()) {
    name = "the variable " + option->get_envname();
  } else if (!name.starts_with("-")) {
    std::transform(name.begin(), name.end(), name.begin(), ::toupper);
  }
  return name + (what.starts_with("must ") ? " " : ": ") + what;
}

/// Replaces this process by another program; returns only on failure.
void HandOver(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execvp(arguments.front(), arguments.data());
}

int RunBench(std::vector<std::string> words) {
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  words.insert(words.begin(), folder / "coopdyn-bench");
  HandOver(words);
  PrintError(
      "coopdyn: coopdyn bench needs the program coopdyn-bench in {}. In the folder of the sources, build it "
      "with cmake --build --preset release --target coopdyn-bench\n",
      folder.string());
  return kExitErrors;
}

/// Replaces this program by the Python program clients/NAME: sweeps use Dask, grading starts what students
/// wrote.
int RunPython(const std::string& name, std::vector<std::string> words) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::string python = PythonProgram();
  if (const std::filesystem::path folder = FolderWithClient(name); !folder.empty()) {
    words.insert(words.begin(), {python, folder / "clients" / name, program, folder});
    HandOver(words);
    PrintError("coopdyn: coopdyn {} needs Python 3: {} cannot be started\n", name, python);
    return kExitErrors;
  }
  PrintError("coopdyn: coopdyn {0} needs the folder clients/{0} of the sources or of the installation\n",
             name);
  return kExitErrors;
}

int RunSweep(std::vector<std::string> words) {
  return RunPython("sweep", std::move(words));
}

int RunGrade(std::vector<std::string> words) {
  return RunPython("grade", std::move(words));
}

/// Runs `serve` with the options of YARS.
int RunYars(std::vector<std::string> words) {
  YarsWords read = ReadYarsWords(words);
  if (!read.told.empty()) {
    PrintLines(read.told);
    return kExitOk;
  }
  if (!read.error.empty()) {
    PrintError("coopdyn: {} (coopdyn yars --help shows how to write it)\n", read.error);
    return kExitWrongUse;
  }
  for (const std::string& note : read.notes) PrintError("coopdyn: {}\n", note);
  std::vector<const char*> arguments = {"coopdyn", "serve"};
  for (const std::string& word : read.serve) arguments.push_back(word.c_str());
  return RunCommandLine(static_cast<int>(arguments.size()), arguments.data());
}

/// Adds a command that parses its own words, including --help.
void AddHandedOver(CLI::App& app, const char* name, const char* what, int (*run)(std::vector<std::string>),
                   Chosen& chosen) {
  CLI::App* sub = app.add_subcommand(name, what);
  sub->set_help_flag();
  sub->prefix_command();
  sub->callback([sub, run, &chosen] { chosen = [run, words = sub->remaining()] { return run(words); }; });
}

/// The hidden command with which `serve` starts the process that runs loaded controllers.
void AddControllerChild(CLI::App& app, Chosen& chosen) {
  const auto fd = std::make_shared<int>(-1);
  // An empty group hides it from --help.
  CLI::App* child =
      app.add_subcommand("controller-child", "Started by serve: runs loaded controllers")->group("");
  child->add_option("fd", *fd)->required();
  child->callback([&chosen, fd] { chosen = [fd] { return RunControllerChild(*fd); }; });
}

}  // namespace

int RunCommandLine(int argc, const char* const* argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  std::string command_line = argv[0];
  for (const std::string& argument : arguments) command_line += " " + argument;
  Chosen chosen;
  CLI::App app("coopdyn, a multi-robot simulator daemon", "coopdyn");
  app.set_version_flag("--version", std::string("coopdyn ") + kVersion);
  app.require_subcommand(1);
  app.footer("Example: coopdyn serve classroom");
  AddServe(app, command_line, chosen);
  AddCheck(app, chosen);
  AddConvert(app, chosen);
  AddHost(app, chosen);
  AddRemote(app, chosen);
  AddDoctor(app, chosen);
  AddControllerChild(app, chosen);
  AddNewController(app, chosen);
  AddDescribe(app, chosen);
  AddVerify(app, chosen);
  AddExport(app, chosen);
  AddInfo(app, chosen);
  AddHandedOver(app, "bench", "Measure the speed of this machine and build", RunBench, chosen);
  AddHandedOver(app, "yars", "Run an experiment of YARS, with the options of YARS", RunYars, chosen);
  AddHandedOver(app, "sweep", "Run a scenario with many values, controllers and seeds", RunSweep, chosen);
  AddHandedOver(app, "grade", "Grade what students hand in, by a scenario's scores", RunGrade, chosen);
  try {
    CheckCommand(app, arguments);
    CheckValues(app, arguments);
    InsertConfig(app, arguments);
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 expects reverse order
  } catch (const CLI::Success& success) {                                       // --help, --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    PrintError("coopdyn: {}\n", Explained(app, error, arguments));
    return kExitWrongUse;
  }
  return chosen();
}

CLI::Validator NumberIn(double least, double most, bool above) {
  const auto check = [=](const std::string& text) -> std::string {
    double value = 0;
    const bool number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
    if (!number) return "must be a finite number, not " + text;
    if (value > most) return "must be at most " + FormatNumber(most) + ", not " + text;
    if (above ? value > least : value >= least) return {};
    return (above ? "must be above " : "must be at least ") + FormatNumber(least) + ", not " + text;
  };
  const char bracket = above ? '(' : '[';
  return {check, fmt::format("FLOAT in {}{} - {}]", bracket, FormatNumber(least), FormatNumber(most))};
}

CLI::Validator WholeIn(std::int64_t least, std::int64_t most) {
  const auto check = [=](const std::string& text) -> std::string {
    std::int64_t value = 0;
    if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most) return {};
    return fmt::format("must be a whole number from {} to {}, not {}", least, most, text);
  };
  return {check, fmt::format("INT in [{} - {}]", least, most)};
}

CLI::Validator OneOf(std::vector<std::string> words) {
  const std::string names = fmt::format("{{{}}}", fmt::join(words, ","));
  const auto check = [words = std::move(words)](const std::string& text) -> std::string {
    if (std::ranges::find(words, text) != words.end()) return {};
    const std::string nearest = Nearest(text, words);
    return "must be " + fmt::format("{}", fmt::join(words.begin(), words.end() - 1, ", ")) + " or " +
           words.back() + ", not " + text + (nearest.empty() ? "" : "; did you mean " + nearest + "?");
  };
  return {check, names};
}

std::string Explained(const CLI::App& app, const CLI::ParseError& error,
                      const std::vector<std::string>& arguments) {
  std::vector<CLI::App*> chosen = app.get_subcommands();
  const bool mismatch = dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr;
  if (chosen.empty() && mismatch) chosen = {app.get_subcommand(arguments.front())};  // by CheckValues()
  const CLI::App& command = chosen.empty() ? app : *chosen.back();
  const std::string said = error.what();  // e.g. "--port: …", "run is required"
  std::string what = said;
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    const std::string word = app.remaining(true).at(0);
    what = word + " is one word too many";
    if (chosen.empty()) {
      std::vector<std::string> commands;
      for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
        commands.push_back(sub->get_name());
      }
      what = "there is no command " + word + ": write one of " + JoinNames(commands);
    }
    if (word.starts_with("--")) {
      std::vector<std::string> flags;
      for (const CLI::Option* option : command.get_options()) flags.push_back(option->get_name());
      const std::string nearest = Nearest(word.substr(0, word.find('=')), flags);
      what = "there is no option " + word + (nearest.empty() ? "" : ": did you mean " + nearest + "?");
    }
  } else if (mismatch) {
    // CLI11: "--port: 1 required INT missing", "--port: At Most 1 …", "--eye: FLOAT only partially …".
    const std::string name = said.substr(0, said.find(':'));
    const CLI::Option* option = command.get_option_no_throw(name);
    const int numbers = option == nullptr ? 1 : option->get_items_expected_max();
    what = name + (said.find("missing") != std::string::npos ? " needs a value"
                   : numbers > 1 ? fmt::format(" takes {} numbers with commas between them", numbers)
                                 : " may be given once");
  } else if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr && said.find(" = ") != said.npos) {
    const std::size_t equals = said.find(" = ");  // "Could not convert: --from = x"
    what = said.substr(said.find(": ") + 2, equals - said.find(": ") - 2) + " must be a number, not " +
           said.substr(equals + 3);
  } else if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !chosen.empty()) {
    std::string name = said.substr(0, said.find(' '));
    std::transform(name.begin(), name.end(), name.begin(), ::toupper);
    what = name + " is missing";
  } else if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr && said.find(": ") != said.npos) {
    what = WrongValue(command, said, arguments);
  }
  if (chosen.empty() && dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) {
    return what + " (" + app.get_name() + " --help shows the commands)";
  }
  return what + " (" + app.get_name() + (chosen.empty() ? "" : " " + command.get_name()) +
         " --help shows how to write it)";
}

SearchPath DataPath(const std::vector<std::string>& given) {
  SearchPath path;
  path.folders.assign(given.begin(), given.end());
  if (const char* variable = std::getenv("COOPDYN_PATH")) {
    std::istringstream stream(variable);
    for (std::string folder; std::getline(stream, folder, ':');) {
      if (!folder.empty()) path.folders.emplace_back(folder);
    }
  }
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  // Controllers built with the program.
  if (std::filesystem::is_directory(program / "controllers", error)) path.folders.push_back(program);
  // Installed (bin/ beside share/), or in the build tree (build/<preset>/).
  for (const char* relative : {"../share/coopdyn", "../.."}) {
    const std::filesystem::path folder = std::filesystem::weakly_canonical(program / relative, error);
    if (std::filesystem::is_directory(folder / "robots", error)) path.folders.push_back(folder);
  }
  AddModelFolders(path);
  return path;
}

}  // namespace coopdyn
