// SPDX-License-Identifier: MIT
#include <memory>
#include <string>
#include <vector>

#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/print.h"
#include "server/app/progress_bar.h"
#include "server/replay/verify.h"

namespace coopdyn {

namespace {

struct GivenRuns {
  std::string run, other;
  int threads = 1;
  std::vector<std::string> scenario_folders;
};

/// Opens a recording; prints the error and returns null on failure.
std::unique_ptr<RunReader> Open(const std::string& file) {
  std::string error;
  auto reader = RunReader::Open(file, error);
  if (reader == nullptr) {
    PrintError("coopdyn: verify: {}\n", error);
  } else if (reader->mended()) {
    PrintError("{}: had not been closed; it is mended\n", file);
  } else if (reader->growing()) {
    PrintError("{}: is being recorded; verified as far as it is now\n", file);
  }
  return reader;
}

int RunVerify(const GivenRuns& given) {
  const auto run = Open(given.run);
  if (run == nullptr) return kExitErrors;
  const auto other = given.other.empty() ? nullptr : Open(given.other);
  if (other == nullptr && !given.other.empty()) return kExitErrors;

  const LogBackend log("warning");
  const SteadyClock clock;
  WorkerPool pool(given.threads);
  ControllerOptions controllers;
  controllers.threads = given.threads;
  const SearchPath path = DataPath(given.scenario_folders);
  const ReplayServices services{clock, log.logger(), pool, controllers, path};

  VerifyReport report;
  {
    ProgressBar bar(clock, log.logger());
    const Progress progress = [&bar](double share) { bar.Show(share); };
    report = other == nullptr ? Verify(*run, services, progress) : Compare(*run, *other, services, progress);
  }
  if (!report.error.empty()) {
    PrintErrorLines("coopdyn: verify: " + ToString(report));
    return kExitErrors;
  }
  PrintLines(ToString(report));
  return report.difference ? kExitErrors : kExitOk;
}

}  // namespace

void AddVerify(CLI::App& app, Chosen& chosen) {
  const auto given = std::make_shared<GivenRuns>();
  CLI::App* sub = app.add_subcommand("verify", "Repeat a recorded run and compare it, or two runs");
  sub->footer(
      "Prints 'equal, N steps', exit code 0; or the first step, body and value that differ, exit code 1.\n"
      "With OTHER it compares two recordings: where they diverge, and how; or, if they are\n"
      "equal, whether one was changed after it was written, exit code 1.\n"
      "Examples: coopdyn verify lesson1.run\n"
      "          coopdyn verify monday.run tuesday.run");
  sub->add_option("run", given->run, "A recorded run, NAME.run")->required();
  sub->add_option("other", given->other, "Another recorded run to compare with");
  sub->add_option("--threads", given->threads, "Threads of sensing, controllers and physics")
      ->capture_default_str()
      ->check(WholeIn(1, 64));
  sub->add_option("--scenarios", given->scenario_folders, "A folder with controllers that the run names")
      ->allow_extra_args(false);  // the next word is a run
  sub->callback([&chosen, given] { chosen = [given] { return RunVerify(*given); }; });
}

}  // namespace coopdyn
