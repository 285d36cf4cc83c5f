// SPDX-License-Identifier: MIT
#include <array>
#include <boost/json.hpp>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>

#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "protocol/module_tables.h"
#include "protocol/text_scan.h"
#include "server/app/commands.h"
#include "server/app/print.h"
#include "server/app/remote_connection.h"
#include "server/devices/module_core.h"
#include "server/model/text_file.h"
#include "server/model/values.h"

namespace coopdyn {

namespace {

namespace json = boost::json;

struct RemoteOptions {
  std::string verb;                // list, status, run, …, call
  std::vector<std::string> words;  // the following words
  std::shared_ptr<ServerOptions> at;
};

struct Verb {
  const char* name;
  std::int32_t command;  // command of /simulation; 0 if the verb is not one
  const char* help;
  const char* example;
  std::size_t min_words, max_words;
};

constexpr Verb kVerbs[] = {
    {"list", 0, "List the names of all modules", "coopdyn list", 0, 0},
    {"status", command::kGetStatus, "Show the state of the run", "coopdyn status", 0, 0},
    {"run", command::kRun, "Continue the run", "coopdyn run", 0, 0},
    {"pause", command::kPause, "Pause the run", "coopdyn pause", 0, 0},
    {"step", command::kStep, "Run N steps while paused", "coopdyn step 10", 0, 1},
    {"reset", command::kReset, "Reset to the start, with another seed if given", "coopdyn reset 7", 0, 1},
    {"reload", command::kReload, "Read the scenario's file again", "coopdyn reload", 0, 0},
    {"load", command::kLoadScenario,
     "Load another scenario: a bare name, a file of this machine, or - (standard input)",
     "coopdyn load corridor", 1, 1},
    {"world", 0,
     "Show or edit the world: list, insert, remove, move, set, rename, undo, redo, "
     "save",
     "coopdyn world insert \"[BOX_*] | type box | size 0.5 0.5 0.5 | position 2 1\"    coopdyn world move "
     "BOX_1 2 "
     "1    coopdyn world save mine.scenario",
     1, 1 << 20},
    {"stop-all", command::kStopAll, "Stop all robots", "coopdyn stop-all", 0, 0},
    {"quit", command::kQuit, "End the daemon", "coopdyn quit", 0, 0},
    {"call", 0, "Send any command to any module",
     "coopdyn call /robot1/motors set_velocity 0.2 0.5    coopdyn call /robot1/target get_target \"red\"", 2,
     1 << 20},
};

/// A shell word as written in a line of the text encoding.
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

/// Parses `word`; throws RemoteError with `wanted` if it is not a number from `least` on.
std::int32_t WholeNumber(const std::string& word, std::int32_t least, const std::string& wanted) {
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc() && end == word.data() + word.size() && value >= least) return value;
  throw RemoteError(kExitWrongUse, wanted);
}

// Fields of a status; a key that is missing or has another type reads as a default.
double NumberAt(const json::object& object, const char* key) {
  const json::value* value = object.if_contains(key);
  return value != nullptr && value->is_number() ? value->to_number<double>() : 0.0;
}
std::string WordAt(const json::object& object, const char* key) {
  const json::value* value = object.if_contains(key);
  return value != nullptr && value->is_string() ? std::string(value->as_string()) : "-";
}
json::array ArrayAt(const json::object& object, const char* key) {
  const json::value* value = object.if_contains(key);
  return value != nullptr && value->is_array() ? value->as_array() : json::array();
}

/// `, silent for 12 s, stopped until its next command`; empty if the client is active.
std::string SilenceOf(const json::object& robot) {
  const double silent_s = std::floor(NumberAt(robot, "silent_s"));
  std::string text = silent_s < 1 ? "" : fmt::format(", silent for {:.0f} s", silent_s);
  const json::value* stopped = robot.if_contains("watchdog_stopped");
  if (stopped != nullptr && *stopped == true) text += ", stopped until its next command";
  return text;
}

void PrintRobots(const json::array& robots) {
  constexpr std::size_t kListed = 40;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (i == kListed)
      return Print("... and more: coopdyn call /simulation get_status FIRST COUNT tells all\n");
    const json::object& robot = robots[i].as_object();
    const std::string owner = WordAt(robot, "owner");
    const json::value* moving = robot.if_contains("still_moving");
    const bool moves = moving != nullptr && *moving == true;
    const std::string free = moves ? "nobody drives it, still moving" : "free";
    Print("{:<16} {:<10} {}\n", WordAt(robot, "name"), WordAt(robot, "type"),
          owner == "-" || owner.empty() ? free : "driven by " + owner + SilenceOf(robot));
  }
}

void PrintStatus(const std::string& text) {
  boost::system::error_code error;
  const json::value parsed = json::parse(text, error);
  if (error || !parsed.is_object() || !parsed.as_object().contains("protocol"))
    throw RemoteError(kExitErrors, "the daemon's status is unreadable");
  const json::object& status = parsed.as_object();
  Print("{}  {}  {}  t = {:.3f} s  step {:.0f}  real-time factor {:.2f}\n", WordAt(status, "scenario"),
        WordAt(status, "mode"), WordAt(status, "state"), NumberAt(status, "time_s"), NumberAt(status, "step"),
        NumberAt(status, "rtf"));
  const json::value* playback = status.if_contains("playback");
  const bool plays = playback != nullptr && playback->is_object();
  const double speed = NumberAt(plays ? playback->as_object() : status, "speed");  // 0: no limit
  Print("speed: {}\n", speed == 0 ? "no limit" : fmt::format("{:g} times real time", speed));
  if (plays) Print("playing {}\n", WordAt(playback->as_object(), "file"));
  if (const std::string recording = WordAt(status, "recording"); recording != "-") {
    const std::string stall = WordAt(status, "recording_stalled");
    const double lost = NumberAt(status, "recording_lost");
    Print("{}{}\n", stall == "-" ? "recording to " + recording : "not recording to " + recording + " for now",
          lost > 0 ? fmt::format(", {:.0f} step{} lost", lost, lost == 1 ? "" : "s") : "");
    if (stall != "-") Print("  {}\n", stall);
  }
  std::string cure = "-";
  for (const json::value& one : ArrayAt(status, "awaiting")) {
    const json::object& awaited = one.as_object();
    Print("waiting for {} ({}), {:.1f} s\n", WordAt(awaited, "robot"), WordAt(awaited, "why"),
          NumberAt(awaited, "seconds"));
    if (cure == "-") cure = WordAt(awaited, "cure");
  }
  if (cure != "-") Print("  {}\n", cure);
  for (const json::value& one : ArrayAt(status, "scores")) {
    const json::object& score = one.as_object();
    const json::value* value = score.if_contains("value");
    const bool known = value != nullptr && value->is_number();
    const std::string until = WordAt(score, "until");
    Print("score {}: {}{}\n", WordAt(score, "name"),
          known ? fmt::format("{:.6g} {}", NumberAt(score, "value"), WordAt(score, "unit")) : "not known yet",
          until.empty() || until == "-" ? "" : ", until " + until);
  }
  for (const json::value& one : ArrayAt(status, "logged")) {
    const json::object& logged = one.as_object();
    Print("logged {}: {:.6g} at {:.3f} s\n", WordAt(logged, "name"), NumberAt(logged, "value"),
          NumberAt(logged, "time_s"));
  }
  PrintRobots(ArrayAt(status, "robots"));
}

void List(RemoteConnection& connection) {
  for (const std::string& line : connection.AskNames("list")) {
    std::istringstream words(line);
    std::string registration, name_word, name, ip_word, ip, port_word, port;
    words >> registration >> name_word >> name >> ip_word >> ip >> port_word >> port;
    if (name_word == "name") Print("{:<28} {}:{}\n", name, ip, port);
  }
}

/// The request for a verb that is a command of /simulation.
Message MakeRequest(const RemoteOptions& options, std::int32_t command) {
  Message request;
  request.command = command;
  const std::string first = options.words.empty() ? std::string() : options.words.front();
  if (command == command::kStep) {
    request.params = {
        first.empty() ? 1
                      : WholeNumber(first, 1, "step takes a number of steps from 1, e.g. coopdyn step 10")};
  } else if (command == command::kReset && !first.empty()) {
    request.params = {WholeNumber(first, 0, "reset takes a seed from 0, e.g. coopdyn reset 7")};
  } else if (command == command::kLoadScenario) {
    request.text = first;
    std::error_code ignored;
    if (IsPipe(first) || std::filesystem::is_regular_file(first, ignored)) {
      std::ifstream file(first == kPipe ? "/dev/stdin" : first, std::ios::binary);
      request.text.assign(std::istreambuf_iterator<char>(file), {});
      request.text += "\n# file: " + std::filesystem::path(first).filename().string() + "\n";
    }
  }
  return request;
}

/// The request to /world for the `words` of `coopdyn world`.
Message WorldMessageOf(const std::vector<std::string>& words) {
  const std::string& verb = words.front();
  const CommandTable& table = *FindModuleTable("world");
  const CommandSpec* spec = table.Find(verb == "move" ? "set_pose" : verb);
  if (spec == nullptr || spec->id < command::kInsert || spec->id > command::kGetWorld) {
    throw RemoteError(
        kExitWrongUse,
        verb +
            " is not a command of coopdyn world: write list, insert, remove, move, set, rename, "
            "undo, redo or save");
  }
  Message request;
  request.command = spec->id;
  if (spec->id == command::kSaveWorld) return request;
  const bool has_numbers = !spec->data.empty();
  std::size_t next = 1;
  if (has_numbers && spec->text != TextUse::kNone && next < words.size()) request.text = words[next++];
  for (; next < words.size(); ++next) {
    if (has_numbers) {
      const std::optional<double> number = ParsePlain(words[next]);
      if (!number)
        throw RemoteError(kExitWrongUse,
                          "'" + words[next] + "' is no number: coopdyn world " + spec->example);
      request.data.push_back(*number);
    } else {
      request.text += (request.text.empty() ? "" : " ") + words[next];
    }
  }
  std::error_code ignored;
  if (spec->id == command::kInsert && std::filesystem::is_regular_file(request.text, ignored)) {
    std::ifstream file(request.text, std::ios::binary);
    request.text.assign(std::istreambuf_iterator<char>(file), {});
  }
  return request;
}

void PrintWorld(const std::string& text) {
  boost::system::error_code error;
  const json::value parsed = json::parse(text, error);
  if (error || !parsed.is_object()) throw RemoteError(kExitErrors, "the daemon's answer is unreadable");
  for (const char* kind : {"things", "robots", "targets", "lights"}) {
    for (const json::value& one : ArrayAt(parsed.as_object(), kind)) {
      const json::object& thing = one.as_object();
      std::string place;
      for (const json::value& x : ArrayAt(thing, "position"))
        place += fmt::format(" {:8.3f}", x.to_number<double>());
      const std::string type = WordAt(thing, "type");
      Print("{:>8.0f}  {:<20} {:<12}{}\n", NumberAt(thing, "id"), WordAt(thing, "name"),
            type == "-" ? std::string(kind).substr(0, std::string_view(kind).size() - 1) : type, place);
    }
  }
}

void SayHello(RemoteConnection& connection, const std::string& token) {
  if (token.empty()) return;
  Message hello;
  hello.command = command::kHello;
  hello.text = "coopdyn-call " + token;
  if (const Message reply = connection.Call(hello); reply.error != 0)
    throw RemoteError(kExitErrors, reply.text);
}

/// The message for an error reply: a hint if the token is missing, else `text`.
std::string Refusal(const Message& reply, std::string text) {
  const bool wants_token = reply.text == ModuleCore::NotAllowed(reply).text;
  return wants_token ? "this needs the daemon's token: give it with --token, or in COOPDYN_TOKEN" : text;
}

/// Runs `coopdyn world`.
void CallWorld(RemoteConnection& connection, const RemoteOptions& options, const Message& request) {
  connection.Open("/world");
  SayHello(connection, options.at->token);
  const Message reply = connection.Call(request);
  if (reply.error != 0) throw RemoteError(kExitErrors, Refusal(reply, reply.text));
  if (request.command == command::kListWorld) return PrintWorld(reply.text);
  if (request.command != command::kSaveWorld) return Print("{}: {}\n", options.words.front(), reply.text);
  if (options.words.size() < 2) return Print("{}", reply.text);
  std::ofstream file(options.words[1], std::ios::binary);
  file << reply.text;
  file.close();
  if (!file)
    throw RemoteError(kExitErrors, options.words[1] + " cannot be written: choose another folder or name");
  Print("saved as {}\n", options.words[1]);
}

/// Puts the file's name back into diagnostics of a file that was sent as text.
std::string WithFileName(std::string text, const RemoteOptions& options) {
  constexpr std::string_view kText = "(text):";
  if (options.verb != "load") return text;
  for (std::size_t at = text.find(kText); at != std::string::npos; at = text.find(kText, at)) {
    text.replace(at, kText.size() - 1, options.words.front());
  }
  return text;
}

/// Explains `reply`, the line of an error reply: its text and the meaning of its code.
std::string InWords(const std::string& reply) {
  constexpr std::array kMeanings = {"ok",           "unknown command", "wrong params", "wrong data",
                                    "out of range", "not possible",    "owned",        "malformed",
                                    "too large",    "internal error",  "no such name", "timed out",
                                    "not allowed"};
  const Decoded decoded = DecodeText(reply + "\n", *FindModuleTable("simulation"), false);
  const Message& error = decoded.message;
  const auto code = static_cast<std::size_t>(error.error);
  if (decoded.status != DecodeStatus::kMessage || code >= kMeanings.size()) return reply;
  return Refusal(error, fmt::format("{} (error {}, {})", error.text, code, kMeanings[code]));
}

void CallModule(RemoteConnection& connection, const RemoteOptions& options) {
  connection.Open(options.words[0]);
  const std::string& token = options.at->token;
  if (!token.empty()) {
    const std::string reply = connection.CallLine("hello coopdyn-call " + token);
    if (!reply.starts_with("0 ")) throw RemoteError(kExitErrors, InWords(reply));
  }
  std::string line = options.words[1];
  for (std::size_t i = 2; i < options.words.size(); ++i) line += ' ' + Quoted(options.words[i]);
  const std::string first = line.substr(0, line.find(' '));
  if (first.empty() || first == "help" || first == "verbose") {
    return PrintLines(connection.AskComments(line));
  }
  const std::string reply = connection.CallLine(line);
  if (!reply.starts_with("0 ")) throw RemoteError(kExitErrors, InWords(reply));
  PrintLines(reply + "\n");
  // A robot stops when a client that said hello disconnects. Release it, so that a single command stays in
  // force.
  if (!token.empty()) connection.CallLine("release");
}

/// Sends one command to /simulation.
void CallSimulation(RemoteConnection& connection, const RemoteOptions& options, const Message& request) {
  connection.Open("/simulation");
  SayHello(connection, options.at->token);
  const Message reply = connection.Call(request);
  if (reply.error != 0) throw RemoteError(kExitErrors, Refusal(reply, WithFileName(reply.text, options)));
  if (request.command == command::kGetStatus) return PrintStatus(reply.text);
  Print("{}: ok{}\n", options.verb, Moment(reply));
  if (request.command == command::kStopAll && !reply.text.empty()) Print("{}\n", reply.text);
}

int Remote(const RemoteOptions& options, const Verb& verb) {
  try {
    const ServerAddress server(options.at->server, options.at->seat);
    const bool is_world = options.verb == "world";
    const Message request = is_world ? WorldMessageOf(options.words) : MakeRequest(options, verb.command);
    RemoteConnection connection(server);
    if (is_world) {
      CallWorld(connection, options, request);
      return kExitOk;
    }
    if (options.verb == "list") {
      List(connection);
    } else if (options.verb == "call") {
      CallModule(connection, options);
    } else {
      CallSimulation(connection, options, request);
    }
    return kExitOk;
  } catch (const RemoteError& error) {
    const std::string text = error.what();
    PrintErrorLines("coopdyn: " + text + (text.ends_with('\n') ? "" : "\n"));
    return error.code;
  }
}

}  // namespace

void AddRemote(CLI::App& app, Chosen& chosen) {
  for (const Verb& verb : kVerbs) {
    CLI::App* sub = app.add_subcommand(verb.name, verb.help);
    sub->footer(std::string("Example: ") + verb.example);
    // Numbers may be negative: treat unknown options as words.
    if (verb.max_words > 0) sub->allow_extras();
    sub->callback([sub, at = AddServerOptions(*sub), &verb, &chosen] {
      const RemoteOptions options{verb.name, sub->remaining(), at};
      if (options.words.size() < verb.min_words || options.words.size() > verb.max_words) {
        throw CLI::ValidationError(std::string("write e.g. ") + verb.example);
      }
      chosen = [options, &verb] { return Remote(options, verb); };
    });
  }
}

}  // namespace coopdyn
