// SPDX-License-Identifier: MIT
// The raw message by the name of its command.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clients/cpp/coopdyn_client.h"

namespace coopdyn::client {

/// Looks `command` up in what `module` says about itself (a number stands for itself), sends it, and waits at
/// most `timeout_s` for the reply.
Reply RawCall(Session& session, const std::string& module, const std::string& command,
              std::vector<std::int32_t> params, std::vector<double> data, const std::string& text,
              double timeout_s);

}  // namespace coopdyn::client
