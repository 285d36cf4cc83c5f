// SPDX-License-Identifier: MIT
// The commands of a robot's thrusters.
#include "protocol/command_ids.h"
#include "protocol/common_commands.h"
#include "protocol/module_tables.h"
#include "protocol/spec_parts.h"

namespace coopdyn {

CommandTable ThrustersTable() {
  ValueSpec thruster = Repeated("thruster");
  thruster.min = 1;
  CommandSpec get = Reading(command::kGetThrusts, "get_thrusts",
                            "Returns how each thruster pushes or turns its link, and how fast that moves "
                            "along or about its direction.",
                            {Repeated("thrust", "N or N m"), Repeated("velocity", "m/s or rad/s")});
  get.params = {thruster};
  CommandSpec set{.id = command::kSetThrusts,
                  .name = "set_thrusts",
                  .help = "Sets the forces and torques of thrusters.",
                  .params = {thruster},
                  .data = {Repeated("thrust", "N or N m")},
                  .reply_params = StepReplyParams(),
                  .reply_data = StepReplyData(),
                  .reply_text = "`limited to …` if it was beyond the limits",
                  .example = "set_thrusts (1) 0.5"};
  CommandSpec limits =
      Reading(command::kGetThrusterLimits, "get_thruster_limits", "Returns what the thrusters are able to.",
              {Repeated("max_thrust", "N or N m")});
  limits.reply_text = "the thrusters' names, separated by spaces";
  return CommandTable("thrusters", {std::move(get), std::move(set), std::move(limits)});
}

}  // namespace coopdyn
