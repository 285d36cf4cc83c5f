// SPDX-License-Identifier: MIT
// The axes of a joint with up to six axes. One thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/rosiml/experiment.h"
#include "server/rosiml/reader.h"

namespace coopdyn::rosiml {

/// The axes of a <generic> of the public grammar that are not locked, starting at its source.
std::vector<Joint> ReadGenericAxes(const Element& generic, Reader& reader);

/// The default axes of a connector of the paper's `type` (universal, hinge2, sixAxis).
std::vector<Joint> AxesOfType(std::string_view type);

/// The axis `name` of such a connector, added if the type allows it; else null.
Joint* FindAxis(std::vector<Joint>& axes, std::string_view type, const std::string& name);

}  // namespace coopdyn::rosiml
