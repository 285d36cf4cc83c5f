// SPDX-License-Identifier: MIT
// The commands of a robot's muscles.
#include "protocol/command_ids.h"
#include "protocol/common_commands.h"
#include "protocol/module_tables.h"
#include "protocol/spec_parts.h"

namespace coopdyn {

CommandTable MusclesTable() {
  ValueSpec muscle = Repeated("muscle");
  muscle.min = 1;
  CommandSpec get =
      Reading(command::kGetMuscles, "get_muscles",
              "Returns what each muscle is told, how it pulls, how long it is and how fast it "
              "grows longer, and the factors of length and velocity.",
              {Repeated("activation"), Repeated("force", "N"), Repeated("length", "m"),
               Repeated("velocity", "m/s"), Repeated("length_factor"), Repeated("velocity_factor")});
  get.params = {muscle};
  CommandSpec set{.id = command::kSetActivations,
                  .name = "set_activations",
                  .help = "Sets how much of their force muscles give, from 0 to 1.",
                  .params = {muscle},
                  .data = {Repeated("activation")},
                  .reply_params = StepReplyParams(),
                  .reply_data = StepReplyData(),
                  .reply_text = "`limited to …` if it was beyond the limits",
                  .example = "set_activations (1) 0.5"};
  CommandSpec limits =
      Reading(command::kGetMuscleLimits, "get_muscle_limits", "Returns what the muscles are able to.",
              {Repeated("max_force", "N"), Repeated("optimal_length", "m"), Repeated("max_velocity", "m/s")});
  limits.reply_text = "the muscles' names, separated by spaces";
  return CommandTable("muscles", {std::move(get), std::move(set), std::move(limits)});
}

}  // namespace coopdyn
