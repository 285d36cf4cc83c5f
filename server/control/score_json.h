// SPDX-License-Identifier: MIT
// The scores of a run as JSON: what get_status, the page and --summary tell. Pure; any thread.
#pragma once

#include <boost/json.hpp>

#include "server/state/frame.h"

namespace coopdyn {

/// [{"name":"reach","value":3,"unit":"","met":true}]; `value` null: it cannot be told; `met` null: no
/// `until`.
boost::json::array ScoresJson(const Frame& frame);

}  // namespace coopdyn
