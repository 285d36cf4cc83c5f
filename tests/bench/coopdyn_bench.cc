// SPDX-License-Identifier: MIT
// coopdyn-bench: executed by `coopdyn bench`, which its messages name.
#include <CLI/CLI.hpp>
#include <csignal>
#include <functional>

#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/print.h"
#include "tests/bench/bench_commands.h"

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  std::function<int()> chosen;
  CLI::App bench("Measure the speed of this machine and build", "coopdyn bench");
  bench.footer("Example: coopdyn bench swarm --robots 1000");
  bench.require_subcommand(0, 1);
  coopdyn::AddBenchSwarm(bench, chosen);
  coopdyn::AddBenchRobot(bench, chosen);
  coopdyn::AddBenchLockstep(bench, chosen);
  coopdyn::AddBenchRecording(bench, chosen);
  coopdyn::AddBenchSensors(bench, chosen);
  try {
    bench.parse(argc, argv);
    if (!chosen) {
      throw CLI::ValidationError(
          "write what to measure: coopdyn bench swarm, robot, lockstep, recording or sensors");
    }
  } catch (const CLI::Success& help) {
    return bench.exit(help);
  } catch (const CLI::ParseError& error) {
    coopdyn::PrintError("coopdyn: {}\n",
                        coopdyn::Explained(bench, error, std::vector<std::string>(argv + 1, argv + argc)));
    return coopdyn::kExitWrongUse;
  }
  try {
    return chosen();
  } catch (const std::exception& error) {
    coopdyn::PrintError("coopdyn bench: {}\n", error.what());
    return coopdyn::kExitErrors;
  }
}
