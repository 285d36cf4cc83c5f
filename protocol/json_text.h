// SPDX-License-Identifier: MIT
// The text of a JSON value (RFC 8259), for all JSON that coopdyn writes. Pure; any thread.
#pragma once

#include <string>

#include <boost/json/fwd.hpp>

namespace coopdyn {

/// Numbers are written as in the text encoding (0.5, not Boost's 5E-1); null if not finite. In strings, bytes
/// that are not UTF-8 become U+FFFD, and '<', '>' and '&' are escaped, so that the JSON can be embedded in a
/// page.
std::string JsonText(const boost::json::value& value);

}  // namespace coopdyn
