// SPDX-License-Identifier: MIT
// list, status, run, pause, step, reset, reload, load, stop-all, quit, call: one request to a running daemon.
#include <boost/json.hpp>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "protocol/command_ids.h"
#include "protocol/text_scan.h"
#include "server/app/commands.h"
#include "server/app/print.h"
#include "server/app/remote_connection.h"
#include "server/model/text_file.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

int Fail(int code, const std::string& text) {
  PrintErrorLines("coopdyn: " + text + (text.ends_with('\n') ? "" : "\n"));
  return code;
}

/// A word of the shell as it stands in a line of the text encoding.
std::string Quoted(const std::string& word) {
  if (word.find_first_of(" \t\r\n\"\\") == std::string::npos && !word.empty()) return word;
  std::string out;
  AppendQuotedText(word, out);
  return out;
}

std::string Moment(const Message& reply) {
  if (reply.data.size() < 2) return {};
  std::ostringstream out;
  out.precision(10);
  out << " at t = " << reply.data[reply.data.size() - 2] << " s, step "
      << static_cast<std::int64_t>(reply.data.back());
  return out.str();
}

/// The number that `word` is; nothing if it is none or not in [low, high].
std::optional<std::int32_t> WholeNumber(const std::string& word, std::int32_t low) {
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || value < low) return std::nullopt;
  return value;
}

/// How fast time may go in a run or a playback.
std::string SpeedOf(const json::object& status) {
  const json::value* speed = status.if_contains("speed");
  if (speed == nullptr || !speed->is_number()) return "no limit";
  std::ostringstream out;
  out << speed->to_number<double>() << " times real time";
  return out.str();
}

int PrintStatus(const std::string& text) {
  boost::system::error_code error;
  const json::value parsed = json::parse(text, error);
  if (error || !parsed.is_object()) return Fail(kExitErrors, "the daemon's status is unreadable");
  const json::object& status = parsed.as_object();
  const auto number = [&status](const char* key) {
    const json::value* value = status.if_contains(key);
    return value != nullptr && value->is_number() ? value->to_number<double>() : 0.0;
  };
  const auto word = [](const json::object& object, const char* key) {
    const json::value* value = object.if_contains(key);
    return value != nullptr && value->is_string() ? std::string(value->as_string()) : std::string("-");
  };
  Print("{}  {}  {}  t = {:.3f} s  step {:.0f}  real-time factor {:.2f}\n", word(status, "scenario"),
        word(status, "mode"), word(status, "state"), number("time_s"), number("step"), number("rtf"));
  const json::value* playback = status.if_contains("playback");
  const bool plays = playback != nullptr && playback->is_object();
  Print("speed: {}\n", SpeedOf(plays ? playback->as_object() : status));
  if (plays) Print("playing {}\n", word(playback->as_object(), "file"));
  if (const std::string recording = word(status, "recording"); recording != "-") {
    const std::string stall = word(status, "recording_stalled");
    const double lost = number("recording_lost");
    Print("{}{}\n", stall == "-" ? "recording to " + recording : "not recording to " + recording + " for now",
          lost > 0 ? fmt::format(", {:.0f} step{} lost", lost, lost == 1 ? "" : "s") : "");
    if (stall != "-") Print("  {}\n", stall);
  }
  if (const json::value* awaiting = status.if_contains("awaiting");
      awaiting != nullptr && awaiting->is_array()) {
    std::string cure = "-";
    for (const json::value& one : awaiting->as_array()) {
      const json::object& awaited = one.as_object();
      Print("waiting for {} ({}), {:.1f} s\n", word(awaited, "robot"), word(awaited, "why"),
            awaited.at("seconds").to_number<double>());
      if (cure == "-") cure = word(awaited, "cure");
    }
    if (cure != "-") Print("  {}\n", cure);
  }
  if (const json::value* robots = status.if_contains("robots"); robots != nullptr && robots->is_array()) {
    constexpr std::size_t kListed = 40;
    std::size_t listed = 0;
    for (const json::value& one : robots->as_array()) {
      if (++listed > kListed) {
        Print("... and more: coopdyn call /simulation get_status FIRST COUNT tells all\n");
        break;
      }
      const json::object& robot = one.as_object();
      const std::string owner = word(robot, "owner");
      const json::value* moving = robot.if_contains("still_moving");
      const bool moves = moving != nullptr && moving->is_bool() && moving->as_bool();
      const std::string free = moves ? "nobody drives it, still moving" : "free";
      Print("{:<16} {:<10} {}\n", word(robot, "name"), word(robot, "type"),
            owner == "-" || owner.empty() ? free : "driven by " + owner);
    }
  }
  return kExitOk;
}

int List(RemoteConnection& connection) {
  std::vector<std::string> lines;
  if (const std::string error = connection.AskNames("list", lines); !error.empty())
    return Fail(kExitErrors, error);
  for (const std::string& line : lines) {
    std::istringstream words(line);
    std::string registration, name_word, name, ip_word, ip, port_word, port;
    words >> registration >> name_word >> name >> ip_word >> ip >> port_word >> port;
    if (name_word == "name") Print("{:<28} {}:{}\n", name, ip, port);
  }
  return kExitOk;
}

/// The request of a verb that is one command of /simulation; an error text if its words are wrong.
std::string MakeRequest(const RemoteOptions& options, Message& request) {
  const std::string& verb = options.verb;
  const std::string first = options.words.empty() ? std::string() : options.words.front();
  if (verb == "status") {
    request.command = command::kGetStatus;
  } else if (verb == "run") {
    request.command = command::kRun;
  } else if (verb == "pause") {
    request.command = command::kPause;
  } else if (verb == "step") {
    const auto steps = first.empty() ? std::optional<std::int32_t>(1) : WholeNumber(first, 1);
    if (!steps) return "step takes a number of steps from 1, e.g. coopdyn step 10";
    request.command = command::kStep;
    request.params = {*steps};
  } else if (verb == "reset") {
    request.command = command::kReset;
    if (!first.empty()) {
      const auto seed = WholeNumber(first, 0);
      if (!seed) return "reset takes a seed from 0, e.g. coopdyn reset 7";
      request.params = {*seed};
    }
  } else if (verb == "reload") {
    request.command = command::kReload;
  } else if (verb == "load") {
    request.command = command::kLoadScenario;
    request.text = first;
    std::error_code ignored;
    if (IsPipe(first) || std::filesystem::is_regular_file(first, ignored)) {
      std::ifstream file(first == kPipe ? "/dev/stdin" : first, std::ios::binary);
      request.text.assign(std::istreambuf_iterator<char>(file), {});
      request.text += "\n# file: " + std::filesystem::path(first).filename().string() + "\n";
    }
  } else if (verb == "stop-all") {
    request.command = command::kStopAll;
  } else if (verb == "quit") {
    request.command = command::kQuit;
  }
  return {};
}

/// Diagnostics of a file that was sent as a text carry its name again.
std::string WithFileName(std::string text, const RemoteOptions& options) {
  constexpr std::string_view kText = "(text):";
  if (options.verb != "load") return text;
  for (std::size_t at = text.find(kText); at != std::string::npos; at = text.find(kText, at)) {
    text.replace(at, kText.size() - 1, options.words.front());
  }
  return text;
}

int CallModule(RemoteConnection& connection, const RemoteOptions& options) {
  if (const std::string error = connection.Open(options.words[0]); !error.empty())
    return Fail(kExitErrors, error);
  std::string reply;
  if (!options.token.empty()) {
    if (const std::string error = connection.CallLine("hello coopdyn-call " + options.token, reply);
        !error.empty()) {
      return Fail(kExitErrors, error);
    }
  }
  std::string line = options.words[1];
  for (std::size_t i = 2; i < options.words.size(); ++i) line += ' ' + Quoted(options.words[i]);
  if (const std::string error = connection.CallLine(line, reply); !error.empty())
    return Fail(kExitErrors, error);
  if (!reply.starts_with("0 ")) return Fail(kExitErrors, reply);
  PrintLines(reply + "\n");
  // A robot stops when the program that said hello ends; what a single command sets is to stay.
  if (!options.token.empty()) connection.CallLine("release", reply);
  return kExitOk;
}

}  // namespace

int Remote(const RemoteOptions& options) {
  const auto server = ParseServerAddress(options.server);
  if (!server) {
    return Fail(kExitWrongUse, "--server is HOST or HOST:PORT, e.g. labserver:10000, not " + options.server);
  }
  Message request;
  if (const std::string error = MakeRequest(options, request); !error.empty())
    return Fail(kExitWrongUse, error);
  RemoteConnection connection;
  if (const std::string error = connection.Connect(*server); !error.empty())
    return Fail(kExitNoDaemon, error);
  if (options.verb == "list") return List(connection);
  if (options.verb == "call") return CallModule(connection, options);

  if (const std::string error = connection.Open("/simulation"); !error.empty())
    return Fail(kExitErrors, error);
  Message reply;
  if (!options.token.empty()) {
    Message hello;
    hello.command = command::kHello;
    hello.text = "coopdyn-call " + options.token;
    if (const std::string error = connection.Call(hello, reply); !error.empty())
      return Fail(kExitErrors, error);
    if (reply.error != 0) return Fail(kExitErrors, reply.text);
  }
  if (const std::string error = connection.Call(request, reply); !error.empty())
    return Fail(kExitErrors, error);
  if (reply.error == static_cast<std::int32_t>(Error::kNotAllowed)) {
    return Fail(kExitErrors, "this needs the daemon's token: give it with --token, or in COOPDYN_TOKEN");
  }
  if (reply.error != 0) return Fail(kExitErrors, WithFileName(reply.text, options));
  if (options.verb == "status") return PrintStatus(reply.text);
  Print("{}: ok{}\n", options.verb, Moment(reply));
  if (options.verb == "stop-all" && !reply.text.empty()) Print("{}\n", reply.text);
  return kExitOk;
}

}  // namespace coopdyn
