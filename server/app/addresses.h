// SPDX-License-Identifier: MIT
// Where the daemon listens, and what it tells about that.
#pragma once

#include <string>
#include <vector>

namespace coopdyn {

/// What the values of --host mean, each address once; none: loopback.
std::vector<std::string> Addresses(const std::vector<std::string>& hosts);

/// The first address of this machine that others can reach; empty if there is none.
std::string LanAddress();

/// An error of listening, with what to write: `flags` choose other ports.
std::string WithAdvice(const std::string& error, const char* flags);

/// As it stands before a port in a URL: IPv6 in brackets.
std::string Bracketed(const std::string& host);

}  // namespace coopdyn
