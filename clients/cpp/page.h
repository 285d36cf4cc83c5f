// SPDX-License-Identifier: MIT
// What the daemon's page has: pictures and recordings, over HTTP. One thread.
#pragma once

#include <string>

#include "clients/cpp/address.h"

namespace coopdyn::client {

/// The same URL with the host that reaches the daemon from here.
std::string UrlHere(const Address& daemon, const std::string& url);

/// Copies what the page at `url` ("http://host:port/", of a seat "http://host:port/s/ana/") has at `path` to
/// `file`, whole or not at all, piece by piece. `what` stands in errors: "no picture: …". Throws Error 10 if
/// the page does not have it, 5 if it does not give it or `file` cannot be written, -1 or 11 if the
/// connection broke or nothing comes for `timeout_s`.
void Download(const Address& daemon, const std::string& url, const std::string& path, const std::string& file,
              const std::string& what, double timeout_s);

}  // namespace coopdyn::client
