// SPDX-License-Identifier: MIT
// Requests of YARP's network clients to sensors and drives: each becomes commands of the module.
#pragma once

#include <memory>
#include <string_view>

#include "protocol/command_table.h"
#include "server/yarp/port_name.h"
#include "server/yarp/translator.h"

namespace coopdyn {

/// For a port of the module with command table `table`, with one of the talks kMetadata, kAnalog, kBattery,
/// kLidar, kOdometry, kCamera, kBase and kBaseRpc.
std::unique_ptr<YarpTranslator> MakeDeviceTranslator(YarpTalk talk, std::string_view port,
                                                     const CommandTable& table);

}  // namespace coopdyn
