// SPDX-License-Identifier: MIT
#include "server/app/more_commands.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "server/app/commands.h"
#include "server/app/controller_child.h"
#include "server/app/describe_command.h"
#include "server/app/export_command.h"
#include "server/app/info_command.h"
#include "server/app/new_controller.h"
#include "server/app/print.h"
#include "server/app/verify_command.h"

namespace coopdyn {

namespace {

/// Goes on as the program coopdyn-bench; returns only if there is none.
int HandOverToBench(std::vector<std::string> words) {
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::string program = folder / "coopdyn-bench";
  words.insert(words.begin(), program);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(program.c_str(), arguments.data());
  PrintError(
      "coopdyn: coopdyn bench needs the program coopdyn-bench in {}: build it with cmake --build --preset "
      "release --target coopdyn-bench\n",
      folder.string());
  return kExitErrors;
}

/// What follows `bench` is for that program, --help too.
void AddBench(CLI::App& app, std::function<int()>& chosen) {
  CLI::App* bench = app.add_subcommand("bench", "Measure the speed of this machine and build");
  bench->set_help_flag();
  bench->prefix_command();
  bench->callback(
      [bench, &chosen] { chosen = [words = bench->remaining()] { return HandOverToBench(words); }; });
}

}  // namespace

void AddMoreCommands(CLI::App& app, std::function<int()>& chosen) {
  AddControllerChild(app, chosen);
  AddNewController(app, chosen);
  AddDescribe(app, chosen);
  AddVerify(app, chosen);
  AddExport(app, chosen);
  AddInfo(app, chosen);
  AddBench(app, chosen);
}

}  // namespace coopdyn
