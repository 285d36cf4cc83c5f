// SPDX-License-Identifier: MIT
// Access checks for HTTP requests: against other web pages (Host, Origin) and strangers (token). Pure; any
// thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coopdyn {

/// Answer to a stranger's changing request without the token.
inline constexpr const char* kTokenText =
    "from another machine this needs the token that the daemon printed when it started: enter it at the top "
    "of the page and press Unlock; a program sends it as \"token\"";

/// The name or address in a Host header, in lower case, without the port and the brackets of IPv6; nullopt if
/// it is malformed.
std::optional<std::string> HostName(std::string_view host);

/// True for IP addresses, "localhost" and `names` (any case). Refuses other names, which a foreign DNS server
/// may resolve to this machine.
bool HostAllowed(std::string_view host, const std::vector<std::string>& names);

/// True if `origin` ("http://labserver:10001") names the server in `host`, the Host header of the same
/// request.
bool OriginAllowed(std::string_view origin, std::string_view host);

/// The token of an Authorization header; empty if it is not `Bearer TOKEN`.
std::string_view BearerToken(std::string_view authorization);

}  // namespace coopdyn
