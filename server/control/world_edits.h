// SPDX-License-Identifier: MIT
// Converts requests to /world into changes of the world in a frame, and the world into text. Pure, except
// that texts may name files to read; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/message.h"
#include "server/model/readers.h"
#include "server/state/run_control.h"
#include "server/state/world_change.h"

namespace coopdyn {

/// A change, or an error.
struct ResolvedEdit {
  WorldChange change = {};
  Error error = Error::kOk;
  std::string text = {};  // the error's text; else warnings
};

/// Inserts the sections of `text`; " | " may replace a line end, and [NAME_*] gets the next free number.
ResolvedEdit ResolveInsert(const Frame& frame, const std::string& text, RobotLibrary& robots);
/// Removes the things with these names in `text` and these WorldIds; a name may be an id.
ResolvedEdit ResolveRemove(const Frame& frame, const std::string& text, std::span<const std::int32_t> ids);
/// `values`: x y, x y z, x y z yaw, or x y z and w x y z.
ResolvedEdit ResolveSetPose(const Frame& frame, const std::string& name, std::span<const std::int32_t> ids,
                            std::span<const double> values);
/// "BOX_1 color red | mass 2".
ResolvedEdit ResolveSet(const Frame& frame, const std::string& text, RobotLibrary& robots);
ResolvedEdit ResolveRename(const Frame& frame, const std::string& text);

/// WorldIds of the things that `change` adds, replaces or removes; names of those that it adds or replaces.
std::vector<std::int32_t> IdsOf(const WorldChange& change);
std::string NamesOf(const WorldChange& change);

/// The world as a scenario's text, with the poses of `frame`.
std::string WorldText(const Frame& frame, const RunStatus& status);
/// Everything in the world (docs/protocol.md).
std::string WorldJson(const Frame& frame, const RunStatus& status);

}  // namespace coopdyn
