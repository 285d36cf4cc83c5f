// SPDX-License-Identifier: MIT
// The axes of a joint that has up to six. One thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/rosiml/experiment.h"
#include "server/rosiml/reader.h"

namespace coopdyn::rosiml {

/// The axes of a <generic> of the public grammar, from its source on; without those that are locked.
std::vector<Joint> ReadGenericAxes(const Element& generic, Reader& reader);

/// The axes that a connector of the paper's `type` (universal, hinge2, sixAxis) has before it says more of
/// them.
std::vector<Joint> AxesOfType(std::string_view type);

/// The axis called `name` of such a connector, added if the type allows; null if it does not.
Joint* FindAxis(std::vector<Joint>& axes, std::string_view type, const std::string& name);

}  // namespace coopdyn::rosiml
