// SPDX-License-Identifier: MIT
// The addresses on which the daemon listens and that it reports.
#pragma once

#include <string>
#include <vector>

namespace coopdyn {

/// The addresses that the values of --host stand for, without duplicates; no value: loopback.
std::vector<std::string> Addresses(const std::vector<std::string>& hosts);

/// The first non-loopback IPv4 address of this machine; empty if there is none.
std::string LanAddress();

/// A listening error with advice; `flags` are the options that choose other ports.
std::string WithAdvice(const std::string& error, const char* flags);

/// `host` as written before a port in a URL: IPv6 in brackets.
std::string Bracketed(const std::string& host);

}  // namespace coopdyn
