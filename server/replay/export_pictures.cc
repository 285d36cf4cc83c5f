// SPDX-License-Identifier: MIT
#include "server/replay/export_pictures.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "server/model/values.h"
#include "server/record/player_frames.h"
#include "server/replay/ffmpeg.h"
#include "server/replay/run_table.h"
#include "server/replay/verify_chain.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

std::string_view Text(const ImageResult& picture) {
  return {reinterpret_cast<const char*>(picture.bytes->data()), picture.bytes->size()};
}

/// Whether `name` is like 000001.png.
bool IsNumberedPicture(const std::string& name) {
  const auto dot = name.find('.');
  return dot >= 6 && dot != std::string::npos && name.substr(dot) == ".png" &&
         name.find_first_not_of("0123456789") == dot;
}

/// Why `out` cannot become a folder of pictures; empty if it can.
std::string CheckFolder(const std::string& out, bool overwrite) {
  std::error_code code;
  const fs::file_status status = fs::symlink_status(out, code);
  if (out.empty()) return "--out: write the name of a folder";
  if (!fs::exists(status)) return {};
  if (!fs::is_directory(status)) return out + " is a file: write the name of a folder with --out";
  if (!overwrite && !fs::is_empty(out, code))
    return out + " is there already: --force overwrites it, --out PATH writes elsewhere";
  for (const auto& entry : fs::directory_iterator(out, code)) {
    const std::string name = entry.path().filename().string();
    if (!IsNumberedPicture(name))
      return out + " holds more than pictures (" + name + "): it is not overwritten; choose another --out";
  }
  return code ? out + " cannot be read: " + code.message() : "";
}

/// Why the rows for `begin` to `end` cannot be trusted; empty if they are unchanged.
std::string WhyDamagedBetween(RunReader& reader, Nanoseconds begin, Nanoseconds end) {
  const auto first = reader.StepAt(begin, true), last = first ? reader.StepAt(end, true) : std::nullopt;
  if (last) return WhyDamaged(reader, *first, *last);
  return reader.error().empty() ? "this run was recorded without poses" : reader.error();
}

/// A new folder under a temporary name; removed unless committed.
class NewFolder {
 public:
  explicit NewFolder(std::string path) : path_(std::move(path)) {}
  ~NewFolder() {
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  std::string Make() {
    const std::string name = FreeNameBeside(path_);
    std::error_code code;
    if (!fs::create_directory(name, code))
      return path_ + " cannot be made: " + (code ? code.message() : "its name is taken");
    temporary_ = name;
    return {};
  }
  std::string Commit() {
    std::error_code code;
    fs::remove_all(path_, code);
    if (!code) fs::rename(temporary_, path_, code);
    if (code) return path_ + " cannot be written: " + code.message();
    temporary_.clear();
    return {};
  }
  std::string File(const std::string& name) const { return temporary_ + "/" + name; }

 private:
  std::string path_, temporary_;
};

/// The times of the run that `options` select. Sets `error` if there are none or a number is unusable.
FilmTimes ChooseTimes(RunReader& reader, const ExportOptions& options, const PictureOptions& pictures,
                      std::string& error) {
  constexpr double kMinSpeed = 1e-3, kMaxSpeed = 1e3, kMinFps = 0.01, kMaxFps = 1000;
  constexpr std::uint64_t kMaxPictures = 10'000'000;
  const RunExtent extent = reader.extent();
  FilmTimes times{extent.begin, extent.end, pictures.fps, pictures.speed};
  if (!(times.fps >= kMinFps && times.fps <= kMaxFps)) error = "--fps: write pictures per second, e.g. 25";
  if (!(times.speed >= kMinSpeed && times.speed <= kMaxSpeed))
    error = "--speed: write how many simulated seconds pass in a second of the film, e.g. 2";
  if (error.empty() && options.from_s) error = ToNanoseconds("--from", *options.from_s, times.begin);
  if (error.empty() && options.until_s) error = ToNanoseconds("--until", *options.until_s, times.end);
  if (!error.empty()) return times;
  const bool turned = times.begin > times.end && times.begin <= extent.end && times.end >= extent.begin;
  times.begin = std::max(times.begin, extent.begin);
  times.end = std::min(times.end, extent.end);
  if (turned) {
    error = "--from is after --until";
  } else if (times.begin > times.end) {
    error = fmt::format("the run lasts from {} to {} s: choose --from and --until in between",
                        FormatNumber(ToSeconds(extent.begin)), FormatNumber(ToSeconds(extent.end)));
  } else if (times.count() > kMaxPictures) {
    error =
        fmt::format("these would be {} pictures: choose a time range, a larger --speed or a smaller --fps",
                    times.count());
  } else {
    error = WhyDamagedBetween(reader, times.begin, times.end);
  }
  return times;
}

/// Draws the pictures of a run in order.
class Film {
 public:
  Film(RunReader& reader, const PictureOptions& options)
      : reader_(reader), moments_(reader), maker_(options.renderer) {}

  /// The picture that shows the newest recorded poses at or before `time`.
  ImageResult At(Nanoseconds time, const ImageRequest& image) {
    ImageResult failed;
    const auto step = reader_.StepAt(time, true);
    if (!step) {
      failed.error = reader_.error().empty() ? "this run was recorded without poses" : reader_.error();
      return failed;
    }
    const bool is_new = frame_ == nullptr || frame_->step != *step;
    if (is_new && image.shot) {
      // A camera shows its samples with the noise of the run.
      frame_ = moments_.Make(*step);
      if (frame_ == nullptr) {
        failed.error = reader_.error().empty() ? fmt::format("step {} is damaged", *step) : reader_.error();
        return failed;
      }
    } else if (is_new) {
      const auto recorded = reader_.Read(*step);
      auto scene = recorded ? reader_.SceneOf(recorded->scene) : nullptr;
      auto frame = std::make_shared<Frame>();
      if (scene == nullptr || !FillFrame(*recorded, std::move(scene), reader_.header(), *frame)) {
        failed.error = reader_.error().empty() ? fmt::format("step {} is damaged", *step) : reader_.error();
        return failed;
      }
      frame_ = std::move(frame);
    }
    return maker_.Make(*frame_, image);
  }
  /// Calls `use` with each picture of `times`. Returns an error text, empty on success.
  std::string ForEach(const FilmTimes& times, const ImageRequest& image, const ExportProgress& progress,
                      const std::function<std::string(std::uint64_t number, const ImageResult&)>& use) {
    for (std::uint64_t i = 0; i < times.count(); ++i) {
      const ImageResult picture = At(times.time(i), image);
      if (!picture.error.empty()) return picture.error;
      if (std::string error = use(i + 1, picture); !error.empty()) return error;
      const double share = static_cast<double>(i + 1) / static_cast<double>(times.count());
      if (progress && !progress(share)) return kExportStopped;
    }
    return {};
  }

 private:
  RunReader& reader_;
  PlayFrames moments_;  // for robots' cameras
  PictureMaker maker_;
  std::shared_ptr<const Frame> frame_;  // of the last picture
};

ImageRequest Encoded(ImageRequest image, ImageFormat format) {
  image.format = format;
  return image;
}

}  // namespace

std::uint64_t FilmTimes::count() const {
  // Add a little, so that 1 s at 25 fps includes the picture of its end despite rounding.
  constexpr double kHair = 1e-6;
  return static_cast<std::uint64_t>(ToSeconds(end - begin) * fps / speed + kHair) + 1;
}

Nanoseconds FilmTimes::time(std::uint64_t picture) const {
  const double after_s = static_cast<double>(picture) * speed / fps;
  return std::min(end, begin + static_cast<Nanoseconds>(std::llround(after_s * 1e9)));
}

std::string ExportPictures(RunReader& reader, const ExportOptions& options, const PictureOptions& pictures,
                           const std::string& out, const ExportProgress& progress) {
  std::string error;
  const FilmTimes times = ChooseTimes(reader, options, pictures, error);
  if (error.empty()) error = CheckFolder(out, options.overwrite);
  if (!error.empty()) return error;
  NewFolder folder(out);
  if (error = folder.Make(); !error.empty()) return error;
  error = Film(reader, pictures)
              .ForEach(times, Encoded(pictures.image, ImageFormat::kPng), progress,
                       [&folder](std::uint64_t number, const ImageResult& picture) {
                         ExportFile file(folder.File(fmt::format("{:06}.png", number)));
                         if (std::string failed = file.Open(false); !failed.empty()) return failed;
                         file.Write(Text(picture));
                         return file.Commit();
                       });
  return error.empty() ? folder.Commit() : error;
}

std::string ExportPicture(RunReader& reader, double time_s, const PictureOptions& pictures,
                          const std::string& out, bool overwrite) {
  Nanoseconds time = 0;
  if (std::string error = ToNanoseconds("--time", time_s, time); !error.empty()) return error;
  const RunExtent extent = reader.extent();
  if (time < extent.begin || time > extent.end) {
    return fmt::format("--time {}: the run lasts from {} to {} s", FormatNumber(time_s),
                       FormatNumber(ToSeconds(extent.begin)), FormatNumber(ToSeconds(extent.end)));
  }
  ExportFile file(out);
  if (std::string error = file.Open(overwrite); !error.empty()) return error;
  if (std::string error = WhyDamagedBetween(reader, time, time); !error.empty()) return error;
  const ImageResult picture = Film(reader, pictures).At(time, Encoded(pictures.image, ImageFormat::kPng));
  if (!picture.error.empty()) return picture.error;
  file.Write(Text(picture));
  return file.Commit();
}

std::string ExportVideo(RunReader& reader, const ExportOptions& options, const PictureOptions& pictures,
                        const std::string& out, const ExportProgress& progress) {
  ImageRequest image = Encoded(pictures.image, ImageFormat::kRgb);
  std::string error;
  const FilmTimes times = ChooseTimes(reader, options, pictures, error);
  if (!error.empty()) return error;
  Film film(reader, pictures);
  if (image.shot) {
    const ImageResult first = film.At(times.begin, image);
    if (!first.error.empty()) return first.error;
    image.width = first.width;
    image.height = first.height;
  }
  if (image.width % 2 != 0 || image.height % 2 != 0) {
    return image.shot
               ? fmt::format("the camera has {} x {} pixels, a film needs even numbers: write --to png",
                             image.width, image.height)
               : "--size: the width and the height of a film are even, e.g. 640x480";
  }
  ExportFile file(out);
  if (error = file.Open(options.overwrite); !error.empty()) return error;
  Ffmpeg ffmpeg;
  error = ffmpeg.Start({image.width, image.height, pictures.fps}, file.temporary());
  if (!error.empty()) return error;
  error = film.ForEach(times, image, progress, [&ffmpeg](std::uint64_t, const ImageResult& picture) {
    return ffmpeg.Write(*picture.bytes);
  });
  if (error.empty()) error = ffmpeg.Finish();
  return error.empty() ? file.Commit() : error;
}

}  // namespace coopdyn
