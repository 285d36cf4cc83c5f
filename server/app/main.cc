// SPDX-License-Identifier: MIT
#include <pthread.h>

#include <csignal>
#include <exception>

#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/app/print.h"

namespace {

int Run(int argc, char** argv) {
  using coopdyn::CommandLine;
  const CommandLine line = coopdyn::ParseCommandLine(argc, argv);
  switch (line.action) {
    case CommandLine::Action::kServe:
      return coopdyn::Serve(line.serve);
    case CommandLine::Action::kCheck:
      return coopdyn::Check(line.check);
    case CommandLine::Action::kRemote:
      return coopdyn::Remote(line.remote);
    case CommandLine::Action::kDoctor:
      return coopdyn::Doctor(line.remote);
    case CommandLine::Action::kOther:
      return line.other();
    case CommandLine::Action::kExit:
      break;
  }
  return line.exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  sigset_t report;  // waits until `serve` can answer it: it shall not end one that is just starting
  sigemptyset(&report);
  sigaddset(&report, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &report, nullptr);
  try {
    return Run(argc, argv);
  } catch (const std::exception& exception) {  // e.g. no more threads, no more memory
    coopdyn::PrintError("coopdyn: the system refuses to go on: {}\n", exception.what());
    return coopdyn::kExitErrors;
  }
}
