// SPDX-License-Identifier: MIT
#include "server/app/yars_words.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "server/app/options.h"
#include "server/base/printable.h"
#include "server/base/words.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

enum class Takes { kNothing, kMayTake, kValue };

/// A flag of YARS and its meaning here. `serve`: options of `serve`, with % for the value; empty: the flag
/// has no effect or is an error.
struct YarsFlag {
  std::string_view name;
  Takes takes = Takes::kNothing;
  std::string_view serve = {};
  std::string_view note = {};     // why it has no effect
  std::string_view instead = {};  // what to write instead; then the flag is an error
};

constexpr std::string_view kPage = "the page shows the simulation: open the URL that the program prints";
constexpr std::string_view kFilms =
    "record the run with --record FILE.run, then coopdyn export FILE.run --video";

constexpr std::array kFlags = {
    YarsFlag{"--nogui", Takes::kNothing, "--no-render --no-http"},
    YarsFlag{"--noSimVis", Takes::kNothing, "--no-render --no-http"},
    YarsFlag{"--seed", Takes::kValue, "--seed %"},
    YarsFlag{"--lib", Takes::kValue, "--scenarios %"},
    YarsFlag{"--printComPortsToFile", Takes::kValue, "--channel-ports-to %"},
    YarsFlag{"--pause", Takes::kNothing, "--paused"},
    YarsFlag{"--silent", Takes::kNothing, "--log-level off"},
    YarsFlag{"--record", Takes::kValue, "--record %"},
    YarsFlag{"--port", Takes::kValue, "--port %"},
    YarsFlag{"--channel-port", Takes::kValue, "--channel-port %"},
    YarsFlag{"--drawPeriod", Takes::kValue, {}, kPage},
    YarsFlag{"--follow", Takes::kMayTake, {}, kPage},
    YarsFlag{"--osd", Takes::kMayTake, {}, kPage},
    YarsFlag{"--trace", Takes::kMayTake, {}, kPage},
    YarsFlag{"--geometry", Takes::kValue, {}, kPage},
    YarsFlag{"--textures", Takes::kMayTake, {}, kPage},
    YarsFlag{"--synched", Takes::kMayTake, {}, "a robot with a controller is always waited for"},
    YarsFlag{"--texture", Takes::kMayTake, {}, kPage},
    YarsFlag{"--capture", Takes::kNothing, {}, kFilms},
    YarsFlag{"--captureName", Takes::kValue, {}, kFilms},
    YarsFlag{"--captureFrameRate", Takes::kValue, {}, kFilms},
    YarsFlag{"--captureDirectory", Takes::kValue, {}, kFilms},
    YarsFlag{"--captureVideo", Takes::kMayTake, {}, kFilms},
    YarsFlag{"--captureFrames", Takes::kMayTake, {}, kFilms},
    YarsFlag{"--framesDirectory", Takes::kValue, {}, kFilms},
    YarsFlag{"--vcodec", Takes::kValue, {}, kFilms},
    YarsFlag{
        "--log", Takes::kMayTake, {}, "record the run with --record FILE.run, then coopdyn export FILE.run"},
    YarsFlag{"--noctrl",
             Takes::kNothing,
             {},
             {},
             "write coopdyn serve FILE --mode lockstep --set ROBOT_1.controller= with a --set for each robot "
             "that has a controller"},
    YarsFlag{"--config",
             Takes::kValue,
             {},
             {},
             "write the options here, or coopdyn serve FILE --config OPTIONS with a file of coopdyn's own "
             "options"},
    YarsFlag{
        "--writeConfig", Takes::kMayTake, {}, "coopdyn serve --config reads a file of coopdyn's own options"},
    YarsFlag{"--printTime", Takes::kNothing, {}, "coopdyn status shows the time"},
    YarsFlag{"--printConfig", Takes::kNothing, {}, "coopdyn describe scenario FILE prints what it is"},
    YarsFlag{
        "--printRobotConfiguration", Takes::kNothing, {}, "coopdyn describe robot FILE prints what it is"},
    YarsFlag{"--printKeyboardShortcuts", Takes::kNothing, {}, "the page's help lists its keys"},
    YarsFlag{"--cr", Takes::kNothing, {}, "each line ends with a line feed"},
};

std::optional<double> PositiveOf(const std::string& text) {
  const std::optional<double> value = ParsePlain(text);
  return value && *value > 0 ? value : std::nullopt;
}

/// The output of a flag with which YARS prints something and exits; empty for other flags.
std::string ToldBy(const std::string& flag) {
  if (flag == "--help" || flag == "-h") return YarsHelp();
  if (flag == "--version") return std::string("coopdyn ") + kVersion + "\n";
  if (flag == "--license") return "coopdyn is under the MIT license: its file LICENSE has the text\n";
  if (flag == "--export") return "coopdyn has its grammar in docs/rosiml.xsd\n";
  if (flag == "--list") return "debug: debug, info or silent; what to follow is chosen on the page\n";
  return {};
}

class YarsLine {
 public:
  explicit YarsLine(const std::vector<std::string>& words) : words_(words) {}

  YarsWords Read() {
    for (at_ = 0; at_ < words_.size() && out_.error.empty() && out_.told.empty(); ++at_)
      ReadWord(words_[at_]);
    if (out_.error.empty() && out_.told.empty()) Finish();
    return std::move(out_);
  }

 private:
  void ReadWord(const std::string& word) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    given_ = equals == std::string::npos ? std::nullopt : std::optional(word.substr(equals + 1));
    if (std::string told = ToldBy(name); !told.empty()) {
      out_.told = std::move(told);
    } else if (name == "--xml" || name == "-d" || name == "-x") {
      TakeFile(Value(name, "experiment.xml"));
    } else if (name == "--iterations") {
      ReadIterations(Value(name, "1000"));
    } else if (name == "--simfreq") {
      ReadFrequency(Value(name, "100"));
    } else if (name == "--ctrlfreq") {
      Value(name, "10");
      out_.notes.emplace_back(
          "--ctrlfreq: write it as controllerFrequency or <controller frequency> of the XML");
    } else if (name == "--debug") {
      ReadDebug();
    } else if (name == "--realtime") {
      realtime_ = 1;
      if (!given_ && at_ + 1 < words_.size() && PositiveOf(words_[at_ + 1])) given_ = words_[++at_];
      if (given_) realtime_ = PositiveOf(*given_);
      if (!realtime_) out_.error = "--realtime takes a factor above 0, or nothing: --realtime 2";
    } else if (name == "--norealtime") {
      realtime_.reset();
    } else if (!word.starts_with("-") || word == "-") {
      TakeFile(word);
    } else {
      ReadFlag(name);
    }
  }

  void ReadIterations(const std::string& text) {
    if (!out_.error.empty()) return;
    constexpr double kMost = 1e9;
    const std::optional<double> steps = PositiveOf(text);
    if (!steps || *steps > kMost || *steps != std::floor(*steps)) {
      out_.error =
          "--iterations must be a whole number of steps from 1 to 1,000,000,000, not " + Printable(text);
      return;
    }
    iterations_ = FormatNumber(*steps);
  }

  /// Same rules as `frequency` of an experiment.
  void ReadFrequency(const std::string& text) {
    if (!out_.error.empty()) return;
    constexpr double kLeast_hz = 10, kMost_hz = 2000, kMicro = 1e6;
    const std::optional<double> frequency_hz = PositiveOf(text);
    if (!frequency_hz || *frequency_hz < kLeast_hz || *frequency_hz > kMost_hz) {
      out_.error = "--simfreq must be from 10 to 2000 steps a second, not " + Printable(text);
      return;
    }
    const double step_us = std::round(kMicro / *frequency_hz);
    if (std::abs(step_us * *frequency_hz / kMicro - 1) > 1e-9)
      out_.notes.push_back("--simfreq " + FormatNumber(*frequency_hz) +
                           ": a step is a whole number of microseconds: it is " + FormatNumber(step_us) +
                           " µs");
    step_s_ = step_us / kMicro;
  }

  /// The level is optional.
  void ReadDebug() {
    const auto is_level = [](const std::string& word) {
      return word == "debug" || word == "info" || word == "silent";
    };
    if (!given_ && at_ + 1 < words_.size() && is_level(words_[at_ + 1])) given_ = words_[++at_];
    const std::string level = given_.value_or("debug");
    if (!is_level(level)) out_.error = "--debug takes debug, info or silent, not " + Printable(level);
    out_.serve.insert(out_.serve.end(), {"--log-level", level == "silent" ? "off" : level});
  }

  void ReadFlag(const std::string& name) {
    const auto* const flag =
        std::find_if(kFlags.begin(), kFlags.end(), [&](const YarsFlag& one) { return one.name == name; });
    if (flag == kFlags.end()) {
      std::vector<std::string> names = {"--xml",        "--iterations", "--simfreq", "--realtime",
                                        "--norealtime", "--debug",      "--help",    "--version",
                                        "--license",    "--list",       "--export"};
      for (const YarsFlag& one : kFlags) names.emplace_back(one.name);
      out_.error = "there is no option " + name + " of YARS that coopdyn knows" + DidYouMean(name, names);
      return;
    }
    if (!flag->instead.empty()) {
      out_.error = name + " of YARS is not supported: " + std::string(flag->instead);
      return;
    }
    std::string value;
    if (flag->takes == Takes::kValue) value = Value(name, "VALUE");
    const bool has_next = at_ + 1 < words_.size() && !words_[at_ + 1].starts_with("-");
    if (flag->takes == Takes::kMayTake && !given_ && has_next && !file_.empty()) ++at_;
    if (flag->serve.empty()) {
      out_.notes.push_back(name + " has no effect here: " + std::string(flag->note));
      return;
    }
    for (std::string& word : SplitWords(flag->serve))
      out_.serve.push_back(word == "%" ? value : std::move(word));
  }

  std::string Value(const std::string& name, const std::string& example) {
    if (given_) return *given_;
    if (at_ + 1 < words_.size()) return words_[++at_];
    out_.error = name + " needs a value, e.g. " + name + " " + example;
    return {};
  }

  void TakeFile(const std::string& file) {
    if (!file_.empty() && out_.error.empty())
      out_.error = "one experiment at a time: " + file_ + " or " + file;
    file_ = file == "-" ? "/dev/stdin" : file;
  }

  void Finish() {
    if (file_.empty()) {
      out_.error = "which experiment? Write coopdyn yars --xml experiment.xml";
      return;
    }
    std::vector<std::string> first = {file_, "--channel-quits"};
    // Like YARS: several programs can run at once.
    if (std::ranges::find(out_.serve, "--port") == out_.serve.end()) first.emplace_back("--any-port");
    const auto add = [&first](std::string name, std::string value) {
      first.push_back(std::move(name));
      first.push_back(std::move(value));
    };
    // Like YARS: as fast as possible, and the world waits for the robots' programs.
    add("--mode", realtime_ ? "realtime" : "lockstep");
    add("--speed", realtime_ ? FormatNumber(*realtime_) : "0");
    if (step_s_) add("--step", FormatNumber(*step_s_));
    if (iterations_) add("--steps", *iterations_);
    out_.serve.insert(out_.serve.begin(), first.begin(), first.end());
  }

  const std::vector<std::string>& words_;
  std::size_t at_ = 0;
  std::optional<std::string> given_;  // value of NAME=VALUE
  std::string file_;
  std::optional<std::string> iterations_;
  std::optional<double> step_s_, realtime_;
  YarsWords out_;
};

}  // namespace

YarsWords ReadYarsWords(const std::vector<std::string>& words) {
  return YarsLine(words).Read();
}

std::string YarsHelp() {
  std::string text =
      "Run an experiment of YARS, with the options of YARS\n"
      "Usage: coopdyn yars --xml EXPERIMENT.xml [OPTIONS]\n\n"
      "  --xml FILE, -d FILE        The experiment; - reads it from a pipe\n"
      "  --iterations N             End after N steps\n"
      "  --realtime [FACTOR]        As fast as the wall clock, or FACTOR times; without it as fast as it "
      "goes\n"
      "  --simfreq HZ               Steps a second, instead of the file's\n"
      "  --debug [LEVEL]            Level of the log: debug, info or silent\n";
  for (const YarsFlag& flag : kFlags) {
    if (flag.serve.empty()) continue;
    const std::string name = std::string(flag.name) + (flag.takes == Takes::kValue ? " VALUE" : "");
    text += fmt::format("  {:<26} As coopdyn serve {}\n", name, flag.serve);
  }
  return text +
         "\nOptions of YARS for its window and its films are accepted without effect.\n"
         "--noctrl and --config are errors that say what to write instead.\n";
}

}  // namespace coopdyn
