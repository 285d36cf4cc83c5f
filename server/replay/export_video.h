// SPDX-License-Identifier: MIT
// A recorded run as a film, made by the program ffmpeg. One thread, which makes the GL context.
#pragma once

#include <string>

#include "server/replay/export_pictures.h"

namespace coopdyn {

/// Writes `out` (NAME.mp4). An error text, empty if it is there.
/// @pre LoadScenario() of the reader went well; SIGPIPE is ignored
std::string ExportVideo(RunReader& reader, const ExportOptions& options, const PictureOptions& pictures,
                        const std::string& out, const ExportProgress& progress);

}  // namespace coopdyn
