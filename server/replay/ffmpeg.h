// SPDX-License-Identifier: MIT
// Feeds pictures to the program ffmpeg. One thread. @pre SIGPIPE is ignored: a write to an ffmpeg that has
// exited must fail, not kill this process.
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

/// The arguments of ffmpeg, without its name: reads raw RGB pictures from standard input, writes an MP4 file.
/// `x264`: use the encoder libx264; else ffmpeg's default encoder.
std::vector<std::string> FfmpegArguments(const VideoFormat& format, bool x264, const std::string& out);

class Ffmpeg {
 public:
  Ffmpeg() = default;
  /// Kills ffmpeg if it is still running.
  ~Ffmpeg();
  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;

  /// Starts the ffmpeg on PATH, which overwrites `out`. Returns an error text, empty on success.
  std::string Start(const VideoFormat& format, const std::string& out);
  /// Writes one picture: width · height · 3 bytes. Returns an error text with ffmpeg's message; empty on
  /// success.
  std::string Write(std::span<const std::uint8_t> rgb);
  /// Ends the input and waits for ffmpeg to exit. Returns an error text with ffmpeg's message; empty on
  /// success.
  std::string Finish();

 private:
  pid_t process_ = -1;
  int pictures_ = -1;  // its standard input
  int messages_ = -1;  // its standard error, a memory file: never blocks ffmpeg
};

}  // namespace coopdyn
