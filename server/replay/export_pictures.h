// SPDX-License-Identifier: MIT
// Exports a recorded run as one picture, a folder of numbered pictures, or a film. One thread, which makes
// the GL context.
#pragma once

#include <cstdint>
#include <string>

#include "server/record/run_reader.h"
#include "server/render/picture_maker.h"
#include "server/replay/export_file.h"

namespace coopdyn {

struct PictureOptions {
  ImageRequest image;  // what to draw; the export sets its format
  double fps = 25;     // pictures per second of the film
  double speed = 1;    // simulated seconds per second of the film
  RendererKind renderer = RendererKind::kAuto;
};

/// Simulated times of the pictures of a film: from + i · speed / fps.
struct FilmTimes {
  Nanoseconds begin = 0, end = 0;  // both included
  double fps = 25, speed = 1;

  std::uint64_t count() const;
  Nanoseconds time(std::uint64_t picture) const;
};

// Each returns an error text, empty on success, and ignores robots, objects and every_s of `options`.
// @pre LoadScenario() of the reader succeeded

/// Writes 000001.png … into the new folder `out`. With options.overwrite it replaces a folder of such
/// pictures.
std::string ExportPictures(RunReader& reader, const ExportOptions& options, const PictureOptions& pictures,
                           const std::string& out, const ExportProgress& progress);
/// Writes the picture of `time_s` to the file `out`, which ends in .png.
std::string ExportPicture(RunReader& reader, double time_s, const PictureOptions& pictures,
                          const std::string& out, bool overwrite);
/// Writes the film `out` (NAME.mp4) with the program ffmpeg. @pre SIGPIPE is ignored
std::string ExportVideo(RunReader& reader, const ExportOptions& options, const PictureOptions& pictures,
                        const std::string& out, const ExportProgress& progress);

}  // namespace coopdyn
