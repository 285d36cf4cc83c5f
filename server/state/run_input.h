// SPDX-License-Identifier: MIT
// What requests ask of a run, its world or the player; the inputs of a run that do not stand in its frames,
// and their one text form: a line that a client could send to /simulation, or what happened to a robot. Pure;
// any thread.
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
  LossPolicy policy = LossPolicy::kHold;  // that acts; not kWait
};
/// The robot's client was lost.
struct ClientLost {
  std::string robot;
  LossPolicy policy = LossPolicy::kHold;  // that acts; not kWait
};
/// The robot's loaded controller drives it no more.
struct ControllerStopped {
  std::string robot;
  std::string why;
};
using RobotEvent = std::variant<DeadlineFired, ClientLost, ControllerStopped>;

/// What stands in the world was edited.
using WorldInput = std::variant<WorldChange>;

struct RunInput {
  std::uint64_t step = 0;  // of the frame after which it came: it acts from the next step on
  std::variant<RunEdit, RobotEvent, WorldInput> what;
};

/// What the supervisor has changed in the step before, told by its label.
bool IsSupervisors(const RunInput& input);

/// An input as a recording has it: `set_mode` `lockstep`, `deadline` `robot3 stop`.
struct InputText {
  std::string action, detail;
  bool operator==(const InputText&) const = default;
};
InputText Encode(const RunInput& input);
/// The reverse, for the bytes of any file; nothing if they are no input.
/// `context`: what changes of the world name; a change that names what it does not have is no input.
std::optional<RunInput> DecodeInput(std::uint64_t step, std::string_view action, std::string_view detail,
                                    const SceneContext& context = {});

/// What a request to /simulation, one that its table allows, asks of the run. Nothing if it is another
/// command; or, with `error`, if a value cannot be (error 4).
std::optional<RunEdit> RunEditOf(const Message& request, std::string& error);

/// A scenario to read and load: a name on the search path or the text of a file. Empty: that of now, again.
struct LoadRequest {
  std::optional<std::string> text;
};
/// A saved state to go on from.
struct RestoreRequest {
  std::string name;
};
/// A world edit, or what /simulation has to find for one.
using WorldRequest = std::variant<edit::Reset, LoadRequest, RestoreRequest>;
/// As RunEditOf(), for the world.
std::optional<WorldRequest> WorldEditOf(const Message& request, std::string& error);

/// What a request to /playback, one that its table allows, asks of the player, in this order; empty as above.
std::vector<EditAction> PlaybackEditsOf(const Message& request, std::string& error);

}  // namespace coopdyn
