// SPDX-License-Identifier: MIT
#include "server/replay/export_video.h"

#include "server/replay/export_file.h"
#include "server/replay/ffmpeg.h"

namespace coopdyn {

std::string ExportVideo(RunReader& reader, const ExportOptions& options, const PictureOptions& pictures,
                        const std::string& out, const ExportProgress& progress) {
  ImageRequest image = pictures.image;
  image.format = ImageFormat::kRgb;
  if (image.width % 2 != 0 || image.height % 2 != 0)
    return "--size: the width and the height of a film are even, e.g. 640x480";
  std::string error;
  const FilmTimes times = ChooseTimes(reader, options, pictures, error);
  if (!error.empty()) return error;
  ExportFile file(out);
  if (error = file.Open(options.overwrite); !error.empty()) return error;
  Film film(reader, pictures);
  Ffmpeg ffmpeg;
  error = ffmpeg.Start({image.width, image.height, pictures.fps}, file.temporary());
  if (!error.empty()) return error;
  for (std::uint64_t i = 0; i < times.count(); ++i) {
    const ImageResult picture = film.At(times.time(i), image);
    if (!picture.error.empty()) return picture.error;
    const double share = static_cast<double>(i + 1) / static_cast<double>(times.count());
    if (progress && !progress(share)) return kExportStopped;
    if (error = ffmpeg.Write(*picture.bytes); !error.empty()) return error;
  }
  if (error = ffmpeg.Finish(); !error.empty()) return error;
  return file.Commit();
}

}  // namespace coopdyn
