// SPDX-License-Identifier: MIT
#include <csignal>

#include "server/app/commands.h"
#include "server/app/options.h"

int main(int argc, char** argv) {
  using coopdyn::CommandLine;
  std::signal(SIGPIPE, SIG_IGN);
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
