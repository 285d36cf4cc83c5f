// SPDX-License-Identifier: MIT
// A student's program in a class, for clients_test.py: clients_program SERVER SEAT PIN ACTION... "-" for SEAT
// and PIN: none. Each action prints its result, or `error NAME TEXT`, and the next one follows.
#include <iostream>
#include <optional>
#include <string>

#include "clients/cpp/coopdyn_client.h"

namespace {

namespace client = coopdyn::client;

struct Program {
  std::string server;
  client::Options options = {};
  std::optional<client::Simulation> sim = {};
  std::optional<client::Robot> robot = {};

  void Act(const std::string& action) {
    if (action == "connect") {
      robot.reset();
      sim.emplace(client::connect(server, options));
      robot.emplace(sim->robot("robot1"));
      std::cout << "page " << sim->status()["http"].text() << std::endl;
    } else if (action == "drive") {
      robot->set_velocity(0.2, 0);
      sim->step();
      std::cout << "driven" << std::endl;
    } else if (action == "modules") {
      std::cout << "modules " << sim->modules().size() << std::endl;
    } else if (action == "picture") {
      std::cout << "picture " << sim->snapshot("picture.png") << std::endl;
    } else if (action == "run") {
      const std::string name = sim->stop_recording().name;
      std::cout << "run " << sim->fetch_run(name, "fetched.run") << std::endl;
    } else if (action == "launch") {
      client::launch("classroom", {.options = {"--no-http"}}).close();
      std::cout << "launched" << std::endl;
    } else if (action == "doctor") {
      const bool healthy = client::doctor(server, options);
      std::cout << (healthy ? "healthy" : "ill") << std::endl;
    } else if (action == "wait") {  // for a line on stdin
      std::string line;
      std::cout << "waits" << std::endl;
      std::getline(std::cin, line);
      std::cout << "goes on" << std::endl;
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  Program program{.server = argv[1]};
  if (const std::string seat = argv[2]; seat != "-") program.options.seat = seat;
  if (const std::string pin = argv[3]; pin != "-") program.options.pin = pin;
  for (int i = 4; i < argc; ++i) {
    try {
      program.Act(argv[i]);
    } catch (const client::Error& error) {
      std::cout << "error " << error.name() << " " << error.text() << std::endl;
    }
  }
  return 0;
}
