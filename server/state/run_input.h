// SPDX-License-Identifier: MIT
// Run edits, world edits and playback edits that requests ask for; the inputs of a run that its frames do not
// contain, and their one text form: a line that a client could send to /simulation, or an event of a robot.
// Pure; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocol/message.h"
#include "server/model/scenario.h"
#include "server/state/edits.h"
#include "server/state/scene_code.h"

namespace coopdyn {

/// The robot's client missed its deadline.
struct DeadlineFired {
  std::string robot;
  LossPolicy policy = LossPolicy::kHold;  // the policy that acts; not kWait
};
/// The robot's client was lost.
struct ClientLost {
  std::string robot;
  LossPolicy policy = LossPolicy::kHold;  // the policy that acts; not kWait
};
/// The robot's loaded controller no longer drives it.
struct ControllerStopped {
  std::string robot;
  std::string why;
};
using RobotEvent = std::variant<DeadlineFired, ClientLost, ControllerStopped>;

/// An edit of the world.
using WorldInput = std::variant<WorldChange>;

struct RunInput {
  std::uint64_t step = 0;  // of the frame before the input, which acts from the next step on
  std::variant<RunEdit, RobotEvent, WorldInput> what;
};

/// True if the input is a change by the supervisor in the step before, recognised by its label.
bool IsSupervisors(const RunInput& input);

/// An input as recorded: `set_mode` `lockstep`, `deadline` `robot3 stop`.
struct InputText {
  std::string action, detail;
  bool operator==(const InputText&) const = default;
};
InputText Encode(const RunInput& input);
/// The reverse, for the bytes of any file; nullopt if they are no input. `context` has the things that
/// changes of the world refer to; a change that refers to anything else is no input.
std::optional<RunInput> DecodeInput(std::uint64_t step, std::string_view action, std::string_view detail,
                                    const SceneContext& context = {});

/// The run edit that a request to /simulation asks for, after its check against the table. Nullopt if it is
/// another command, or, with `error` set, if a value is not possible (error 4).
std::optional<RunEdit> RunEditOf(const Message& request, std::string& error);

/// A scenario to read and load: a name on the search path or the text of a file. Nullopt: the current one
/// again.
struct LoadRequest {
  std::optional<std::string> text;
};
/// A saved state to continue from.
struct RestoreRequest {
  std::string name;
};
/// A world edit, or what /simulation must look up to make one.
using WorldRequest = std::variant<edit::Reset, LoadRequest, RestoreRequest>;
/// Like RunEditOf(), for world edits.
std::optional<WorldRequest> WorldEditOf(const Message& request, std::string& error);

/// The edits that a request to /playback asks for, in order, after its check against the table; empty as
/// above.
std::vector<EditAction> PlaybackEditsOf(const Message& request, std::string& error);

}  // namespace coopdyn
