// SPDX-License-Identifier: MIT
#include "server/app/more_commands.h"

#include <CLI/CLI.hpp>

#include "server/app/bench_lockstep.h"
#include "server/app/bench_recording.h"
#include "server/app/bench_swarm.h"
#include "server/app/controller_child.h"
#include "server/app/export_command.h"
#include "server/app/info_command.h"
#include "server/app/new_controller.h"
#include "server/app/verify_command.h"

namespace coopdyn {

void AddMoreCommands(CLI::App& app, std::function<int()>& chosen) {
  AddControllerChild(app, chosen);
  AddNewController(app, chosen);
  AddVerify(app, chosen);
  AddExport(app, chosen);
  AddInfo(app, chosen);
  CLI::App* bench = app.add_subcommand("bench", "Measure the speed of this machine and build");
  bench->require_subcommand(0, 1);
  bench->callback([bench] {
    if (bench->get_subcommands().empty()) {
      throw CLI::ValidationError("write what to measure: coopdyn bench swarm, lockstep or recording");
    }
  });
  bench->footer("Example: coopdyn bench swarm --robots 1000");
  AddBenchSwarm(*bench, chosen);
  AddBenchLockstep(*bench, chosen);
  AddBenchRecording(*bench, chosen);
}

}  // namespace coopdyn
