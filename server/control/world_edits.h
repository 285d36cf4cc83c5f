// SPDX-License-Identifier: MIT
// What requests to /world mean: changes of the world as it stands in a frame, and what it is as text. Pure
// but for files that texts name; any thread.
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

/// A change, or why there is none.
struct ResolvedEdit {
  WorldChange change = {};
  Error error = Error::kOk;
  std::string text = {};  // of the error; else warnings
};

/// The sections of `text`, in which " | " may stand for a line end, and [NAME_*] for the next free number.
ResolvedEdit ResolveInsert(const Frame& frame, const std::string& text, RobotLibrary& robots);
/// Names in `text` and WorldIds; a name may be an id.
ResolvedEdit ResolveRemove(const Frame& frame, const std::string& text, std::span<const std::int32_t> ids);
/// `values`: x y, x y z, x y z yaw, or x y z and w x y z.
ResolvedEdit ResolveSetPose(const Frame& frame, const std::string& name, std::span<const std::int32_t> ids,
                            std::span<const double> values);
/// "BOX_1 color red | mass 2".
ResolvedEdit ResolveSet(const Frame& frame, const std::string& text, RobotLibrary& robots);
ResolvedEdit ResolveRename(const Frame& frame, const std::string& text);

/// WorldIds of what `change` puts there or takes away, and their names in `scene`, the one after it.
std::vector<std::int32_t> IdsOf(const WorldChange& change);
std::string NamesOf(const WorldChange& change);

/// The world as a scenario's text, with the places of `frame`.
std::string WorldText(const Frame& frame, const RunStatus& status);
/// All that stands there (docs/protocol.md).
std::string WorldJson(const Frame& frame, const RunStatus& status);

}  // namespace coopdyn
