// SPDX-License-Identifier: MIT
// A run's scores and logged numbers as JSON, for get_status, the page and --summary. Pure; any thread.
#pragma once

#include <boost/json.hpp>
#include <map>
#include <string>

#include "server/state/frame.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// [{"name":"reach","value":3,"unit":"","met":true,"met_s":4.2,"until":"all","limit_s":60}]; null `value`:
/// undefined; null `met_s`: not met; null `met`, `until` or `limit_s`: the score has none.
boost::json::array ScoresJson(const Frame& frame);
/// [{"name":"energy","value":3.5,"step":20,"time_s":0.2}]: the newest number of each name.
boost::json::array LoggedJson(const std::map<std::string, Logged>& logged);

}  // namespace coopdyn
