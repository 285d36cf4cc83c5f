// SPDX-License-Identifier: MIT
// Requests of a simulation to /world.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>
#include <utility>

#include "clients/cpp/coopdyn_client.h"
#include "clients/cpp/error.h"
#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {

namespace {

constexpr const char* kWorld = "/world";
constexpr double kLoadTimeout_s = 60;

/// Makes an edit and prints its warnings; returns the names of the edited objects.
std::string Edit(Session& session, std::int32_t command, std::string text, std::vector<double> data = {}) {
  const Message reply = session.RequestGlobal(
      kWorld,
      {.command = command, .data = std::move(data), .text = std::move(text), .timeout_s = kLoadTimeout_s});
  const std::size_t end = std::min(reply.text.find('\n'), reply.text.size());
  if (end < reply.text.size()) std::cerr << "coopdyn: " << reply.text.substr(end + 1) << "\n";
  return reply.text.substr(0, end);
}

}  // namespace

std::vector<std::string> Simulation::insert(const std::string& sections) {
  std::string text = sections;
  if (text.find('[') == std::string::npos) {
    std::ifstream file(text, std::ios::binary);
    if (file) text.assign(std::istreambuf_iterator<char>(file), {});
  }
  return Words(Edit(*session_, command::kInsert, std::move(text)));
}

void Simulation::remove(const std::string& name) {
  remove(std::vector<std::string>{name});
}

void Simulation::remove(const std::vector<std::string>& names) {
  if (names.empty()) throw Error(3, "nothing to remove: write sim.remove(\"BOX_1\")");
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + Word(name, "a name");
  Edit(*session_, command::kRemove, std::move(text));
}

void Simulation::move(const std::string& name, const std::vector<double>& position,
                      const std::vector<double>& turn) {
  if (position.size() != 2 && position.size() != 3)
    throw Error(3, "a position is x, y or x, y, z: write sim.move(\"BOX_1\", {2, 1})");
  const bool turns = turn.empty() || (position.size() == 3 && (turn.size() == 1 || turn.size() == 4));
  if (!turns)
    throw Error(
        3,
        "a turn is a yaw or w, x, y, z, and needs x, y and z: write sim.move(\"BOX_1\", {2, 1, 0.25}, "
        "{1.57})");
  std::vector<double> data = position;
  data.insert(data.end(), turn.begin(), turn.end());
  Edit(*session_, command::kSetPose, Word(name, "a name"), std::move(data));
}

void Simulation::change(const std::string& name, const std::map<std::string, std::string>& keys) {
  if (keys.empty()) throw Error(3, "nothing to change: write sim.change(\"BOX_1\", {{\"color\", \"red\"}})");
  std::string text = Word(name, "a name");
  for (const auto& [key, value] : keys) text += "\n" + key + " " + value;
  Edit(*session_, command::kSetThing, std::move(text));
}

void Simulation::rename(const std::string& name, const std::string& new_name) {
  Edit(*session_, command::kRename, Word(name, "a name") + " " + Word(new_name, "a name"));
}

std::string Simulation::undo() {
  return Edit(*session_, command::kUndo, "");
}

std::string Simulation::redo() {
  return Edit(*session_, command::kRedo, "");
}

std::string Simulation::world() {
  return session_->RequestGlobal(kWorld, {.command = command::kListWorld}).text;
}

std::string Simulation::save_scenario(const std::string& file) {
  if (file.empty()) throw Error(3, "no name: write sim.save_scenario(\"mine.scenario\")");
  const std::string text = session_->RequestGlobal(kWorld, {.command = command::kSaveWorld}).text;
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw Error(5, file + " cannot be written: choose another folder or name");
  return file;
}

Picked Simulation::pick(const std::array<double, 3>& origin, const std::array<double, 3>& direction) {
  std::vector<double> data(origin.begin(), origin.end());
  data.insert(data.end(), direction.begin(), direction.end());
  const Message reply = session_->RequestGlobal(kWorld, {.command = command::kPick, .data = std::move(data)});
  Require(reply, 1, 4);
  return {reply.text, {reply.data[0], reply.data[1], reply.data[2]}, reply.data[3]};
}

}  // namespace coopdyn::client
