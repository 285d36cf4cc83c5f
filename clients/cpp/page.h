// SPDX-License-Identifier: MIT
// Downloads pictures and recordings from the daemon's page, over HTTP. One thread.
#pragma once

#include <string>

#include "clients/cpp/address.h"

namespace coopdyn::client {

/// `url` with the host by which this machine reaches the daemon.
std::string UrlHere(const Address& daemon, const std::string& url);

/// Downloads `path` from the page at `url` ("http://host:port/", of a seat "http://host:port/s/ana/") to
/// `file` in chunks; `file` is written completely or not at all. Errors begin with "no `what`: …". Throws
/// Error 10 if the page has no such path, 5 if the page refuses it or `file` cannot be written, -1 if the
/// connection broke, 11 if no bytes arrive for `timeout_s`.
void Download(const Address& daemon, const std::string& url, const std::string& path, const std::string& file,
              const std::string& what, double timeout_s);

}  // namespace coopdyn::client
