// SPDX-License-Identifier: MIT
// Recordings, playback and saved states of a simulation.
#include <algorithm>
#include <cctype>
#include <utility>

#include "clients/cpp/coopdyn_client.h"
#include "clients/cpp/page.h"
#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr double kExportTimeout_s = 600;  // of converting a long recording, or repeating a part of a run
constexpr const char* kRecorder = "/recorder";
constexpr const char* kPlayback = "/playback";

/// The name of a file, which may contain blanks.
const std::string& RunName(const std::string& text) {
  if (Words(text).empty()) throw Error(3, "the name of a recording is a text, not '" + text + "'");
  return text;
}

/// Checks the speed of a playback.
double PlaySpeed(double speed) {
  Finite(speed, "the speed");
  if (speed < -4 || speed > 64 || speed == 0)
    throw Error(4, "a recording is played at -4 to 64 times its speed, below 0 backwards, not " +
                       Written(speed) + ": write sim.play(2), or sim.pause() to hold it");
  return speed;
}

}  // namespace

void Simulation::release_robot(const std::string& name) {
  session_->Control({.command = command::kReleaseRobot, .text = Word(name, "the name of a robot")});
}

void Simulation::save_state(const std::string& name) {
  const std::string word = Word(name, "the name of a state");
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  if (std::isalpha(static_cast<unsigned char>(word[0])) == 0 || word.size() > 63 ||
      !std::all_of(word.begin(), word.end(), fits))
    throw Error(4,
                "the name of a state is a letter, then letters, digits, _ and -, at most 63: write "
                "sim.save_state(\"before_turn\")");
  session_->Control({.command = command::kSaveState, .text = word});
}

void Simulation::restore_state(const std::string& name) {
  session_->Control({command::kRestoreState, {}, {}, Word(name, "the name of a state"), kLoadTimeout_s});
  session_->OnRestored();
}

std::vector<SavedState> Simulation::saved_states() {
  const Message reply = session_->Control({command::kGetSaved});
  const std::vector<std::string> names = Words(reply.text);
  Require(reply, 0, names.size());
  std::vector<SavedState> states;
  for (std::size_t i = 0; i < names.size(); ++i) states.push_back({names[i], reply.data[i]});
  return states;
}

std::string Simulation::record(const std::string& name) {
  return session_
      ->RequestGlobal(kRecorder,
                      {.command = command::kStartRecording, .text = name.empty() ? name : RunName(name)})
      .text;
}

Recorded Simulation::stop_recording() {
  const Message reply =
      session_->RequestGlobal(kRecorder, {.command = command::kStopRecording, .timeout_s = kLoadTimeout_s});
  const std::size_t url =
      std::min(reply.text.find(" http://"), reply.text.size());  // the name may have blanks
  return {reply.text.substr(0, url), UrlHere(session_->address(), reply.text.substr(url))};
}

void Simulation::note(const std::string& text) {
  if (text.empty()) throw Error(3, "no note: write sim.note(\"half-time\")");
  session_->RequestGlobal(kRecorder, {.command = command::kNote, .text = text});
}

std::optional<Recording> Simulation::recording() {
  const Message reply = session_->RequestGlobal(kRecorder, {command::kGetRecording});
  Require(reply, 1, 5);
  if (reply.params[0] == 0) return std::nullopt;
  const auto whole = [&](std::size_t i) { return Whole(reply.data[i]); };
  return Recording{reply.text, reply.data[0], reply.data[1], whole(2), whole(3), whole(4)};
}

std::vector<RunFile> Simulation::recordings() {
  const Json list = Json::Parse(
      session_->RequestGlobal(kRecorder, {.command = command::kListRuns, .timeout_s = kLoadTimeout_s}).text);
  std::vector<RunFile> files;
  for (const Json& f : list.items()) {
    RunFile file{.name = f["name"].text(), .bytes = Whole(f["bytes"].number())};
    if (!f["seconds"].is_null()) file.seconds = f["seconds"].number();
    if (!f["steps"].is_null()) file.steps = Whole(f["steps"].number());
    file.recording = f["recording"].boolean();
    file.url = UrlHere(session_->address(), f["url"].text());
    files.push_back(std::move(file));
  }
  return files;
}

std::string Simulation::fetch_run(const std::string& name, const std::string& file) {
  std::string stem = RunName(name);
  if (stem.ends_with(".run")) stem.resize(stem.size() - 4);
  const std::string to = file.empty() ? stem + ".run" : file;
  try {
    Download(session_->address(), status()["http"].text(),
             "/runs/" + PercentEncoded(stem) + (to.ends_with(".mat") ? ".mat" : ".run"), to, "recording",
             kExportTimeout_s);
  } catch (const Error& e) {
    if (e.code() != 10) throw;
    std::vector<std::string> known;
    for (const RunFile& run : recordings()) known.push_back(run.name);
    throw Error(10, "there is no recording " + stem + ".run; there are: " + ListOf(known));
  }
  return to;
}

Playback Simulation::playback() {
  const Message reply = session_->RequestGlobal(kPlayback, {command::kGetPlayback});
  Require(reply, 3, 4);
  return {reply.data[0],        reply.data[1],        reply.data[2],        reply.data[3],
          reply.params[0] != 0, reply.params[1] != 0, reply.params[2] != 0, reply.text};
}

void Simulation::seek(double time) {
  session_->RequestGlobal(kPlayback, {.command = command::kSeek, .data = {Finite(time, "the time [s]")}});
}

void Simulation::play(std::optional<double> speed) {
  std::vector<double> data;
  if (speed) data.push_back(PlaySpeed(*speed));
  session_->RequestGlobal(kPlayback, {.command = command::kPlay, .data = std::move(data)});
}

void Simulation::set_play_speed(double s) {
  session_->RequestGlobal(kPlayback, {.command = command::kSetPlaySpeed, .data = {PlaySpeed(s)}});
}

void Simulation::skip(int n) {
  if (n == 0) throw Error(4, "n is how many steps to go on, or back if below 0, not 0: write sim.skip(1)");
  session_->RequestGlobal(kPlayback, {command::kSkip, {n}});
}

void Simulation::set_loop(bool on) {
  session_->RequestGlobal(kPlayback, {command::kSetLoop, {on ? 1 : 0}});
}

void Simulation::branch(std::optional<double> time) {
  std::vector<double> data;
  if (time) data.push_back(Finite(*time, "the time [s]"));
  session_->RequestGlobal(kPlayback, {command::kBranch, {}, std::move(data), "", kExportTimeout_s});
  session_->OnRestored();
}

void Simulation::open_run(const std::string& name) {
  if (name.empty()) throw Error(3, "no name: write sim.open_run(\"lesson1\")");
  session_->RequestGlobal(kPlayback, {command::kOpenRecording, {}, {}, name, kExportTimeout_s});
  session_->OnRestored();
}

void Simulation::close_run() {
  session_->RequestGlobal(kPlayback, {command::kCloseRecording});
  session_->OnRestored();
}

}  // namespace coopdyn::client
