// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <map>
#include <optional>
#include <string>

#include "server/app/commands.h"
#include "server/app/daemon.h"
#include "server/app/print.h"
#include "server/app/run_report.h"
#include "server/base/log.h"
#include "server/model/text_file.h"

namespace coopdyn {

namespace {

constexpr Nanoseconds kTick = kNanosecondsPerSecond;
constexpr Nanoseconds kBarTick = kNanosecondsPerSecond / 5;
constexpr Nanoseconds kProgressEvery = 60 * kNanosecondsPerSecond;

/// The run of a started daemon and its reports.
class ServedRun {
 public:
  ServedRun(Daemon& daemon, const Clock& clock, const Logger& logger, const std::string& summary_file)
      : daemon_(daemon), clock_(clock), logger_(logger), summary_file_(summary_file), began_(clock.Now()) {
    if (!summary_file_.empty()) digests_ = DigestsNow(*daemon.report(0).frame);
  }

  RunReport report() const {
    RunReport run = daemon_.report(ToSeconds(clock_.Now() - began_));
    run.digests = digests_;
    return run;
  }

  /// Waits until the daemon must end and reports progress meanwhile.
  void WaitForEnd(Shutdown& shutdown) {
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    bool bar = false;
    Nanoseconds told = began_;
    for (;;) {
      const RunReport run = report();
      bar = terminal && run.status.duration_s > 0;
      if (bar) ShowBelowLog(logger_, ProgressWithBar(run));
      const Nanoseconds now = clock_.Now();
      if (!terminal && now - told >= kProgressEvery) {
        told = now;
        PrintError("{}\n", ProgressLine(run));
      }
      const Shutdown::Wake wake = shutdown.Wait(bar ? kBarTick : kTick);
      if (wake == Shutdown::Wake::kEnd) break;
      if (wake == Shutdown::Wake::kReport) Report();
      daemon_.UpdateSpin();
      daemon_.LogWaiting();
      daemon_.WatchPace();
    }
    if (!bar) return;
    ShowBelowLog(logger_, "");
    PrintError("{}\n", ProgressWithBar(report()));
  }

  /// Writes the summary, if requested. On failure prints an error and returns false.
  bool WriteSummaryOf(const RunReport& run) const {
    if (summary_file_.empty()) return true;
    const std::string error = WriteSummary(summary_file_, SummaryJson(run));
    if (!error.empty()) PrintError("coopdyn: the summary cannot be written: {}\n", error);
    return error.empty();
  }

 private:
  /// Answers SIGUSR1; the run continues.
  void Report() const {
    const RunReport run = report();
    logger_->info("so far: {}", SummaryLine(run));
    WriteSummaryOf(run);
  }

  Daemon& daemon_;
  const Clock& clock_;
  const Logger logger_;
  const std::string summary_file_;
  const Nanoseconds began_;
  std::map<std::string, std::string> digests_;
};

}  // namespace

int Serve(ServeOptions options) {
  SetRendererDefaults();
  if (IsPipe(options.scenario)) {
    // Read it before signals are blocked, so that Ctrl-C ends the wait for the writer.
    Diagnostics diagnostics;
    options.scenario_text = ReadPipe(options.scenario, diagnostics);
    if (!options.scenario_text) {
      PrintErrorLines(diagnostics.ToString());
      return kExitErrors;
    }
  }
  Shutdown shutdown;
  if (options.with_process) {
    if (const std::string why = shutdown.Follow(*options.with_process); !why.empty()) {
      PrintError("coopdyn: --with-process {}: {}: write the number of a process that runs\n",
                 *options.with_process, why);
      return kExitWrongUse;
    }
  }
  const LogBackend log(options.log_level, options.log_file);
  const SteadyClock clock;
  std::optional<EndsAtOnce> starting(std::in_place);
  Daemon daemon(options, log.logger(), shutdown);
  if (const std::string error = daemon.Start(); !error.empty()) {
    PrintErrorLines(error + (error.ends_with('\n') ? "" : "\n"));
    return kExitErrors;
  }
  starting.reset();
  ServedRun served(daemon, clock, log.logger(), options.summary_file);
  PrintErrorLines(daemon.ConnectHints());
  if (options.channel_quits) {
    for (const std::string& line : daemon.ChannelLines()) Print("{}\n", line);
  }
  Print("{}\n", daemon.ReadyLine());
  const double duration_s = daemon.status().duration_s;
  if (duration_s > 0) PrintError("runs to t = {:g} s\n", duration_s);

  served.WaitForEnd(shutdown);

  daemon.Stop();
  const RunReport run = served.report();
  const int code = ExitCode(run);
  if (run.status.duration_s > 0 || code != kExitOk) PrintError("ended: {}\n", SummaryLine(run));
  return served.WriteSummaryOf(run) ? code : kExitErrors;
}

}  // namespace coopdyn
