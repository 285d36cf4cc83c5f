// SPDX-License-Identifier: MIT
// Which picture a URL asks for. Pure; any thread.
#pragma once

#include <string>
#include <string_view>

#include "server/state/image_board.h"

namespace coopdyn {

/// Reads the query of `/snapshot.png?w=640&h=480&eye=x,y,z&look=x,y,z&rays=1` into `request`: an error text,
/// empty if it is good.
std::string ReadImageQuery(std::string_view query, ImageRequest& request);

}  // namespace coopdyn
