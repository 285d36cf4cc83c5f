// SPDX-License-Identifier: MIT
// A recorded run as pictures: one, or a folder of numbered ones. One thread, which makes the GL context.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/record/run_reader.h"
#include "server/render/picture_maker.h"
#include "server/replay/export_options.h"

namespace coopdyn {

struct PictureOptions {
  ImageRequest image;  // what is shown; its format is set by the export
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

/// The times that `options` choose of the run. Sets `error` if there are none, or unusable numbers.
FilmTimes ChooseTimes(RunReader& reader, const ExportOptions& options, const PictureOptions& pictures,
                      std::string& error);

/// Makes the pictures of a run one after the other.
class Film {
 public:
  /// @pre LoadScenario() of `reader`, which outlives this, went well
  Film(RunReader& reader, const PictureOptions& options) : reader_(reader), maker_(options.renderer) {}

  /// The picture that shows the newest recorded poses at or before `time`, encoded as `image` says.
  ImageResult At(Nanoseconds time, const ImageRequest& image);

 private:
  RunReader& reader_;
  PictureMaker maker_;
  std::shared_ptr<const Frame> frame_;  // shown last
};

/// Writes 000001.png … into the new folder `out`. With options.overwrite it replaces a folder of such
/// pictures. Robots, objects and every_s of `options` mean nothing here. An error text, empty if all is well.
/// @pre LoadScenario() of the reader went well; of the next two as well
std::string ExportPictures(RunReader& reader, const ExportOptions& options, const PictureOptions& pictures,
                           const std::string& out, const ExportProgress& progress);
/// Writes the one picture of `time_s` into the file `out`, which ends in .png.
std::string ExportPicture(RunReader& reader, double time_s, const PictureOptions& pictures,
                          const std::string& out, bool overwrite);

}  // namespace coopdyn
