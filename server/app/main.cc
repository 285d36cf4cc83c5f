// SPDX-License-Identifier: MIT
#include <malloc.h>
#include <pthread.h>

#include <csignal>
#include <exception>

#include "server/app/commands.h"
#include "server/app/print.h"

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow any more is an error of writing
  // Small blocks that are freed join their neighbours at once: put off, as glibc does it, that takes a second
  // when 100,000 robots end. Steps do not notice.
  mallopt(M_MXFAST, 0);
  sigset_t report;  // waits until `serve` can answer it: it shall not end one that is just starting
  sigemptyset(&report);
  sigaddset(&report, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &report, nullptr);
  try {
    return coopdyn::RunCommandLine(argc, argv);
  } catch (const std::exception& exception) {  // e.g. no more threads, no more memory
    coopdyn::PrintError("coopdyn: cannot continue: {}\n", exception.what());
    return coopdyn::kExitErrors;
  }
}
