// SPDX-License-Identifier: MIT
// What a simulation tells of recordings, of one that is played, and of saved states. Values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace coopdyn::client {

/// What is being recorded: the file's name, the simulated times [s] and steps it holds, the steps that were
/// left out because the disk could not follow, and its size.
struct Recording {
  std::string name;
  double begin_time = 0, end_time = 0;
  std::int64_t steps = 0, lost = 0, bytes = 0;
};
/// A recording that the daemon has: seconds (simulated) and steps are empty if it cannot be read, url is
/// empty if it cannot be copied now.
struct RunFile {
  std::string name;
  std::int64_t bytes = 0;
  std::optional<double> seconds = {};
  std::optional<std::int64_t> steps = {};
  bool recording = false;
  std::string url = {};
};
/// A recording that was ended: its name, and where the daemon's page has it; empty: there is no page.
struct Recorded {
  std::string name, url;
};
/// How a recording is played: its simulated times [s], the one shown, how fast, whether it goes on, begins
/// again at its end, and is still being recorded; and its name.
struct Playback {
  double begin_time = 0, end_time = 0, time = 0, speed = 1;
  bool playing = false, loop = false, growing = false;
  std::string file;
};
/// A state that the daemon keeps, and its simulated time [s].
struct SavedState {
  std::string name;
  double time = 0;
};

}  // namespace coopdyn::client
