// SPDX-License-Identifier: MIT
// The text of a JSON value (RFC 8259): everything that coopdyn writes as JSON goes through here. Pure; any
// thread.
#pragma once

#include <string>

#include <boost/json/fwd.hpp>

namespace coopdyn {

/// Numbers stand as in the text encoding, 0.5 and not Boost's 5E-1; null if they are not finite. In texts,
/// bytes that are not UTF-8 become U+FFFD, and '<', '>' and '&' are escaped, so that they may stand in a
/// page.
std::string JsonText(const boost::json::value& value);

}  // namespace coopdyn
