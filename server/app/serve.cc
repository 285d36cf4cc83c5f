// SPDX-License-Identifier: MIT
// coopdyn serve: runs the daemon until something ends it.
#include <unistd.h>

#include <fstream>

#include "server/app/commands.h"
#include "server/app/daemon.h"
#include "server/app/print.h"
#include "server/app/run_report.h"
#include "server/base/log_bar.h"

namespace coopdyn {

namespace {

constexpr Nanoseconds kTick = kNanosecondsPerSecond;
constexpr Nanoseconds kBarTick = kNanosecondsPerSecond / 5;
constexpr Nanoseconds kProgressEvery = 60 * kNanosecondsPerSecond;

/// Waits for the end of the daemon, telling now and then how the run goes on.
void WaitForEnd(Daemon& daemon, Shutdown& shutdown, const Clock& clock, const Logger& logger) {
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  const bool bar = terminal && daemon.duration_s() > 0;
  const auto progress = [&daemon] {
    return ProgressWithBar(*daemon.frame(), daemon.status(), daemon.duration_s());
  };
  Nanoseconds told = clock.Now();
  while (!shutdown.Wait(bar ? kBarTick : kTick)) {
    daemon.UpdateSpin();
    daemon.LogWaiting();
    const Nanoseconds now = clock.Now();
    if (bar) {
      ShowBelowLog(logger, progress());
    } else if (!terminal && now - told >= kProgressEvery) {
      told = now;
      PrintError("{}\n", ProgressLine(*daemon.frame(), daemon.status(), daemon.duration_s()));
    }
  }
  if (bar) {
    ShowBelowLog(logger, "");
    PrintError("{}\n", progress());
  }
}

}  // namespace

int Serve(const ServeOptions& options) {
  SetRendererDefaults();
  Shutdown shutdown;
  const LogBackend log(options.log_level);
  const SteadyClock clock;
  Daemon daemon(options, log.logger(), shutdown);
  if (const std::string error = daemon.Start(); !error.empty()) {
    PrintErrorLines(error + (error.ends_with('\n') ? "" : "\n"));
    return kExitErrors;
  }
  const Nanoseconds started = clock.Now();
  PrintErrorLines(daemon.HowToGoOn());
  Print("{}\n", daemon.ReadyLine());
  if (daemon.duration_s() > 0) PrintError("runs to t = {:g} s\n", daemon.duration_s());

  WaitForEnd(daemon, shutdown, clock, log.logger());

  daemon.Stop();
  const RunStatus status = daemon.status();
  const double wall_s = ToSeconds(clock.Now() - started);
  if (daemon.duration_s() > 0) PrintError("ended: {}\n", SummaryLine(*daemon.frame(), status, wall_s));
  if (!options.summary_file.empty()) {
    std::ofstream file(options.summary_file);
    file << SummaryJson(*daemon.frame(), status, wall_s);
    if (!file.flush()) {
      PrintError("coopdyn: the summary could not be written to {}\n", options.summary_file);
      return kExitErrors;
    }
  }
  return status.frozen.empty() && !daemon.recording_failed() ? kExitOk : kExitFrozen;
}

}  // namespace coopdyn
