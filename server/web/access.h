// SPDX-License-Identifier: MIT
// Who may ask for what over HTTP: guards against other web pages (Host, Origin) and strangers (token). Pure;
// any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coopdyn {

/// What a stranger is told who wants to change something without the token.
inline constexpr const char* kTokenText =
    "from another machine this needs the token that the daemon printed when it started: enter it at the top "
    "of the page and press Unlock; a program sends it as \"token\"";

/// The name or address of a Host header, lower case, without port and without the brackets of IPv6; nothing
/// if it is not well-formed.
std::optional<std::string> HostName(std::string_view host);

/// True for IP addresses, "localhost" and `names` (any case): a name that somebody else's DNS resolves to
/// this machine is refused.
bool HostAllowed(std::string_view host, const std::vector<std::string>& names);

/// True if a page of `origin` ("http://labserver:10001") was served by `host`, the Host header of the same
/// request.
bool OriginAllowed(std::string_view origin, std::string_view host);

/// The token of an Authorization header; empty if it is not `Bearer TOKEN`.
std::string_view BearerToken(std::string_view authorization);

}  // namespace coopdyn
