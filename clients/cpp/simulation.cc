// SPDX-License-Identifier: MIT
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <utility>

#include "clients/cpp/coopdyn_client.h"
#include "clients/cpp/page.h"
#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"
#include "protocol/command_table.h"

namespace coopdyn::client {
namespace {

constexpr double kPictureTimeout_s = 30;
constexpr const char* kModes[] = {"realtime", "lockstep", "free"};

int AtLeastOne(int value, const char* what) {
  if (value < 1) throw Error(4, std::string(what) + " must be at least 1, not " + std::to_string(value));
  return value;
}

std::string PointText(const std::vector<double>& point, const char* word) {
  if (point.empty()) return "";
  if (point.size() != 3) throw Error(3, std::string(word) + " is a point: write {x, y, z}");
  std::ostringstream out;
  out << "&" << word << "=" << Finite(point[0], word) << "," << Finite(point[1], word) << ","
      << Finite(point[2], word);
  return out.str();
}

}  // namespace

Simulation::Simulation(std::shared_ptr<Session> session) : session_(std::move(session)) {}

Robot Simulation::robot(const std::string& given) {
  const std::string name = given.substr(std::min(given.find_first_not_of('/'), given.size()));
  if (name.empty() || name.find_first_of("/ \t\n") != std::string::npos)
    throw Error(10, "'" + given + "' is not the name of a robot; write e.g. sim.robot(\"robot1\")");
  return Robot(session_, session_->Drive(name));
}

Robot Simulation::robot(int number) {
  const std::vector<std::string> names = robots();
  if (number < 1 || static_cast<std::size_t>(number) > names.size())
    throw Error(10, "there is no robot " + std::to_string(number) + " of " + std::to_string(names.size()));
  return robot(names[static_cast<std::size_t>(number) - 1]);
}

std::vector<std::string> Simulation::robots() {
  return session_->RobotNames();
}

Team Simulation::team(const std::vector<std::string>& names) {
  std::string text;
  for (std::string name : names) {
    name.erase(0, std::min(name.find_first_not_of('/'), name.size()));
    if (name.empty() || name.find_first_of("/\t\n") != std::string::npos)
      throw Error(10, "'" + name + "' is not the name of a robot or swarm; write e.g. sim.team(\"swarm1\")");
    text += (text.empty() ? "" : " ") + name;
  }
  if (text.empty())
    throw Error(3, "no names: write e.g. sim.team(\"swarm1\"), or sim.team() for all that are free");
  return Team(session_, session_->DriveTeam(text));
}

Team Simulation::team(const std::string& name) {
  return team(std::vector<std::string>{name});
}

Team Simulation::team() {
  return Team(session_, session_->DriveTeam(""));
}

void Simulation::step(int n, double timeout) {
  if (n > kMaxSteps) {
    const std::string most = std::to_string(kMaxSteps);
    throw Error(4, "n must be at most " + most + ", not " + std::to_string(n) + ": write sim.step(" + most +
                       ") and the rest after it");
  }
  session_->Step(AtLeastOne(n, "n"), timeout);
}

double Simulation::time() const {
  return session_->time();
}

std::int64_t Simulation::steps() const {
  return session_->steps();
}

std::string Simulation::mode() {
  const int mode = session_->AskMode();
  return mode >= 0 && mode < 3 ? kModes[mode] : "";
}

double Simulation::dt() {
  return status()["step_s"].number();
}

void Simulation::run() {
  session_->Control({command::kRun});
}

void Simulation::pause() {
  session_->Control({command::kPause});
}

void Simulation::stop_all() {
  session_->Control({command::kStopAll});
  session_->ForgetCommands();
}

void Simulation::reset() {
  session_->Control({.command = command::kReset, .timeout_s = kLoadTimeout_s});
  session_->OnReset();
}

void Simulation::reset(int seed) {
  if (seed < 0) throw Error(4, "a seed is at least 0, not " + std::to_string(seed) + ": write sim.reset(7)");
  session_->Control({command::kReset, {seed}, {}, "", kLoadTimeout_s});
  session_->OnReset();
}

void Simulation::reload() {
  session_->Control({.command = command::kReload, .timeout_s = kLoadTimeout_s});
  session_->Loaded();
}

void Simulation::load_scenario(const std::string& x) {
  if (x.empty()) throw Error(3, "no scenario: write sim.load_scenario(\"corridor\")");
  std::string text = x;
  std::error_code ignored;
  if (x.find('\n') == std::string::npos && std::filesystem::is_regular_file(x, ignored)) {
    std::ifstream file(x, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(file), {});
    text += "\n# file: " + std::filesystem::path(x).filename().string() + "\n";  // tells the daemon the name
  }
  session_->Control({command::kLoadScenario, {}, {}, std::move(text), kLoadTimeout_s});
  session_->Loaded();
}

void Simulation::set_mode(const std::string& mode) {
  const auto* found = std::find(std::begin(kModes), std::end(kModes), mode);
  if (found == std::end(kModes))
    throw Error(4, "there is no mode '" + mode + "'; write one of realtime, lockstep, free");
  const int number = static_cast<int>(found - std::begin(kModes));
  session_->Control({command::kSetMode, {number}});
  session_->set_mode(number);
}

void Simulation::set_step(double s) {
  const double whole_us = std::round(Finite(s, "the step [s]") * 1e6);
  if (s < 0.0005 || s > 0.1)
    throw Error(4, "a step lasts 0.0005 to 0.1 s, not " + Written(s) + ": write sim.set_step(0.01)");
  if (std::abs(s * 1e6 - whole_us) > 1e-3)
    throw Error(4, "a step lasts whole microseconds, not " + Written(s) + " s: write sim.set_step(" +
                       Written(whole_us / 1e6) + ")");
  session_->Control({.command = command::kSetStep, .data = {s}});
}

void Simulation::set_speed(double x) {
  session_->Control({.command = command::kSetSpeed, .data = {Finite(x, "the speed factor")}});
}

void Simulation::set_participants(const std::vector<std::string>& names) {
  session_->Control({.command = command::kSetParticipants, .text = Join(names, " ")});
}

Json Simulation::status() {
  return session_->Status();
}

std::string Simulation::hash() {
  return status()["hash"].text();
}

std::map<std::string, double> Simulation::scores() {
  std::map<std::string, double> all;
  const Json state = status();
  for (const Json& score : state["scores"].items()) {
    const Json& value = score["value"];
    all[score["name"].text()] = value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.number();
  }
  return all;
}

void Simulation::log(const std::string& name, double value) {
  if (!std::isfinite(value)) throw Error(4, "not a finite number: write sim.log(\"energy\", 3.5)");
  session_->RequestGlobal(kSimulation, {.command = command::kLog, .data = {value}, .text = name});
}

std::map<std::string, double> Simulation::logged() {
  std::map<std::string, double> all;
  const Json state = status();
  for (const Json& one : state["logged"].items()) all[one["name"].text()] = one["value"].number();
  return all;
}

void Simulation::end_run(const std::string& why) {
  session_->RequestGlobal(kSimulation, {.command = command::kEndRun, .text = why});
}

std::vector<Awaited> Simulation::waiting() {
  std::vector<Awaited> all;
  const Json state = status();
  for (const Json& a : state["awaiting"].items())
    all.push_back({a["robot"].text(), a["why"].text(), a["seconds"].number()});
  return all;
}

std::string Simulation::snapshot(const std::string& file, const View& view) {
  Download(session_->address(), status()["http"].text(),
           "/snapshot.png?w=" + std::to_string(AtLeastOne(view.w, "w")) +
               "&h=" + std::to_string(AtLeastOne(view.h, "h")) + PointText(view.eye, "eye") +
               PointText(view.look, "look"),
           file, "picture", kPictureTimeout_s);
  return file;
}

Json Simulation::describe(const std::string& name) {
  return session_->Describe(name.starts_with("/") ? name : "/" + name);
}

std::vector<Module> Simulation::modules() {
  session_->RequireOpen();
  return session_->address().Modules();
}

Reply Simulation::call(const std::string& name, const std::string& command, std::vector<std::int32_t> params,
                       std::vector<double> data, const std::string& text, double timeout) {
  const std::string module = name.starts_with("/") ? name : "/" + name;
  Request request{0, std::move(params), std::move(data), text, timeout};
  const char* const end = command.data() + command.size();
  const auto [stopped, error] = std::from_chars(command.data(), end, request.command);
  if (error != std::errc() || stopped != end) {  // not a number: look up the command's id
    std::vector<std::string> names;
    const Json description = session_->Describe(module);
    for (const Json& entry : description["commands"].items()) {
      names.push_back(entry["name"].text());
      if (names.back() == command) request.command = static_cast<std::int32_t>(Whole(entry["id"].number()));
    }
    if (std::find(names.begin(), names.end(), command) == names.end())
      throw Error(1, module + " has no command '" + command + "'; it has: " + Join(names, ", "));
  }
  Message reply = session_->Call(module, std::move(request));
  Require(reply, 0, 0);
  const double time = TimeOf(reply);
  const std::int64_t step = StepOf(reply);
  reply.data.resize(reply.data.size() - 2);
  return {std::move(reply.text), reply.command, std::move(reply.params), std::move(reply.data), time, step};
}

void Simulation::close() {
  session_->Close();
}

Simulation connect(const std::string& server, const Options& options) {
  auto session = std::make_shared<Session>(
      Address(server, options.name, options.token, options.timeout, options.seat, options.pin),
      options.watch);
  const Json status = session->Status();
  if (const std::int64_t spoken = Whole(status["protocol"].number()); spoken != kProtocolVersion)
    throw Error(5, "the daemon at " + session->address().text() + " (version " + status["version"].text() +
                       ") speaks protocol " + std::to_string(spoken) + ", this client speaks " +
                       std::to_string(kProtocolVersion) + ": build it from the daemon's sources");
  session->set_scenario(status["scenario"].text());
  session->Control({command::kGetTime});
  return Simulation(std::move(session));
}

}  // namespace coopdyn::client
