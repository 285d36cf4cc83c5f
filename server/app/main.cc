// SPDX-License-Identifier: MIT
#include <malloc.h>
#include <pthread.h>

#include <csignal>
#include <exception>
#include <new>

#include "server/app/commands.h"
#include "server/app/print.h"

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // writing beyond the file size limit is an error, not the end
  // Disable fastbins, so that freed small blocks merge at once. Deferred merging, glibc's default, takes a
  // second when 100,000 robots are destroyed. Steps are not affected.
  mallopt(M_MXFAST, 0);
  sigset_t report;  // blocked until `serve` can answer it, so that it does not kill a starting daemon
  sigemptyset(&report);
  sigaddset(&report, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &report, nullptr);
  try {
    return coopdyn::RunCommandLine(argc, argv);
  } catch (const std::bad_alloc&) {
    coopdyn::PrintError("coopdyn: cannot continue: not enough memory: load less, or raise the limit\n");
    return coopdyn::kExitErrors;
  } catch (const std::exception& exception) {  // e.g. no more threads
    coopdyn::PrintError("coopdyn: cannot continue: {}\n", exception.what());
    return coopdyn::kExitErrors;
  }
}
