// SPDX-License-Identifier: MIT
// Translates requests to a camera as a frame grabber and as an RGB-D sensor of YARP 3 and 4.
#pragma once

#include <memory>

#include "server/yarp/translator.h"

namespace coopdyn {

/// For requests to a module `camera`.
std::unique_ptr<YarpTranslator> MakeCameraTranslator();

}  // namespace coopdyn
