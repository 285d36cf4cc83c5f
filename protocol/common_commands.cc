// SPDX-License-Identifier: MIT
#include "protocol/common_commands.h"

#include <algorithm>

#include "protocol/command_ids.h"
#include "protocol/usage.h"

namespace coopdyn {

bool IsSubscribable(const CommandSpec& spec) {
  return spec.name.starts_with("get_") && spec.id != command::kGetTime && spec.text == TextUse::kNone &&
         CountFits(spec.params, 0) && spec.data.empty() && spec.no_push.empty();
}

std::vector<std::pair<std::string, std::int32_t>> ModeWords() {
  return {{"realtime", 0}, {"lockstep", 1}, {"free", 2}};
}

ValueSpec StepsParam() {
  return {.name = "steps", .unit = "", .optional = true, .min = 1, .max = kMaxSteps};
}

std::vector<ValueSpec> StepReplyParams() {
  return {{.name = "mode", .unit = "", .enums = ModeWords()},
          {.name = "length", .unit = "", .repeated = true}};
}

std::vector<ValueSpec> StepReplyData() {
  return {{.name = "reading", .unit = "", .repeated = true}};
}

std::vector<CommandSpec> CommonCommands(std::span<const CommandSpec> own) {
  std::vector<std::pair<std::string, std::int32_t>> readings;
  std::string instead;
  for (const CommandSpec& spec : own) {
    if (IsSubscribable(spec)) readings.emplace_back(spec.name, spec.id);
    if (!spec.no_push.empty()) instead += (instead.empty() ? "" : "; ") + spec.no_push;
  }
  const ValueSpec reading{
      .name = "reading", .unit = "", .optional = true, .enums = readings, .instead = instead};
  const ValueSpec any_param{.name = "param", .unit = "", .repeated = true};
  const ValueSpec any_data{.name = "value", .unit = "", .repeated = true, .any_number = true};
  return {
      {.id = command::kPing,
       .name = "ping",
       .help = "Sends the params and data back.",
       .params = {any_param},
       .data = {any_data},
       .reply_params = {any_param},
       .reply_data = {any_data},
       .example = "ping (1 2) 0.5"},
      {.id = command::kDescribe,
       .name = "describe",
       .help = "Returns the commands of this module.",
       .reply_text = "JSON",
       .example = "describe"},
      {.id = command::kReady,
       .name = "ready",
       .help = "Keeps the set-points for the next step, or for a number of steps. The reply comes after the "
               "last of them.",
       .params = {StepsParam()},
       .reply_params = StepReplyParams(),
       .reply_data = StepReplyData(),
       .example = "ready 10"},
      {.id = command::kGetTime,
       .name = "get_time",
       .help = "Returns mode, time and step, and the readings chosen by attach.",
       .reply_params = StepReplyParams(),
       .reply_data = StepReplyData(),
       .example = "get_time"},
      {.id = command::kSubscribe,
       .name = "subscribe",
       .help = "Sends a reading each step, or every n steps, as a message with the command -reading. "
               "Without a reading: the module's first.",
       .params = {{.name = "every", .unit = "steps", .optional = true, .min = 1}, reading},
       .example = "subscribe 10"},
      {.id = command::kUnsubscribe,
       .name = "unsubscribe",
       .help = "Ends the subscription to one reading, or to all.",
       .params = {reading},
       .example = "unsubscribe"},
      {.id = command::kHello,
       .name = "hello",
       .help = "Names this client, with the token if one is needed. A new connection of the same name takes "
               "over from an old one.",
       .text = TextUse::kRest,
       .text_name = "NAME [TOKEN]",
       .example = "hello ana"},
      {.id = command::kClaim,
       .name = "claim",
       .help = "Makes this connection the owner of an actuator module.",
       .example = "claim"},
      {.id = command::kRelease,
       .name = "release",
       .help = "Gives up an actuator module, so that others may own it.",
       .example = "release"},
      {.id = command::kAttach,
       .name = "attach",
       .help = "Chooses modules of the robot. Later replies to actuator commands, ready and get_time carry "
               "their first readings. Without names: none.",
       .text = TextUse::kRest,
       .text_name = "MODULE…",
       .example = "attach distance pose",
       .text_optional = true},
  };
}

}  // namespace coopdyn
