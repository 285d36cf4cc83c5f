// SPDX-License-Identifier: MIT
// The scores of a run, and what was logged, as JSON: what get_status, the page and --summary tell. Pure; any
// thread.
#pragma once

#include <boost/json.hpp>
#include <map>
#include <string>

#include "server/state/frame.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// [{"name":"reach","value":3,"unit":"","met":true,"met_s":4.2,"until":"all","limit_s":60}]; `value` null: it
/// cannot be told; `met_s` null: it is not met; `met`, `until` or `limit_s` null: there is none.
boost::json::array ScoresJson(const Frame& frame);
/// [{"name":"energy","value":3.5,"step":20,"time_s":0.2}]: the newest number of each name.
boost::json::array LoggedJson(const std::map<std::string, Logged>& logged);

}  // namespace coopdyn
