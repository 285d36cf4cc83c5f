// SPDX-License-Identifier: MIT
// The program ffmpeg, fed with pictures. One thread. @pre SIGPIPE is ignored: a write to an ffmpeg that has
// ended must fail, not end us.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace coopdyn {

struct VideoFormat {
  int width = 640, height = 480;  // even
  double fps = 25;
};

/// What ffmpeg is called with, its own name left out: raw RGB pictures on its standard input, an MP4 file
/// out. `x264`: its usual encoder for that, with colours that every player knows; else: its default one.
std::vector<std::string> FfmpegArguments(const VideoFormat& format, bool x264, const std::string& out);

class Ffmpeg {
 public:
  Ffmpeg() = default;
  /// Kills it, if it has not ended.
  ~Ffmpeg();
  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;

  /// Starts the one on PATH; an error text, empty if it runs. `out` is overwritten.
  std::string Start(const VideoFormat& format, const std::string& out);
  /// One picture: width · height · 3 bytes. An error text with what ffmpeg says; empty if all is well.
  std::string Write(std::span<const std::uint8_t> rgb);
  /// No more pictures: waits for its end. An error text with what ffmpeg says; empty if the file is there.
  std::string Finish();

 private:
  pid_t process_ = -1;
  int pictures_ = -1;  // its standard input
  int messages_ = -1;  // what it writes to standard error; nothing waits for it to be read
};

}  // namespace coopdyn
