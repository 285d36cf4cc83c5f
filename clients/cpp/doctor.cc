// SPDX-License-Identifier: MIT
#include <algorithm>
#include <iostream>
#include <vector>

#include "clients/cpp/coopdyn_client.h"

namespace coopdyn::client {

bool doctor(const std::string& server, const Options& options) {
  try {
    const Address address(server, options.name, options.token, options.timeout, options.seat, options.pin);
    std::cout << "ok    server: " << address.text() << std::endl;
    address.DialPort(After(address.timeout_s()));
    const std::string way = address.port() == 0 ? address.text() : std::to_string(address.port());
    std::cout << "ok    port: " << way << " is open" << std::endl;
    const std::size_t modules = address.Modules().size();
    if (!address.seat().empty())
      std::cout << "ok    seat: " << address.seat() << " is yours, by its PIN" << std::endl;
    std::cout << "ok    names: " << modules << " modules; this client needs port " << way << " only"
              << std::endl;
    Simulation sim = connect(server, options);
    const Json status = sim.status();
    std::cout << "ok    versions: daemon " << status["version"].text() << ", protocol "
              << status["protocol"].number() << std::endl;
    std::vector<double> took_s;
    for (int i = 0; i < 50; ++i) {
      const Deadline start = Clock::now();
      sim.mode();
      took_s.push_back(-SecondsUntil(start));
    }
    std::sort(took_s.begin(), took_s.end());
    std::cout << "ok    round trip: " << static_cast<int>(took_s[25] * 1e6) << " us (median of 50), longest "
              << static_cast<int>(took_s.back() * 1e6) << " us" << std::endl;
    std::cout << "ok    time: " << status["mode"].text() << ", " << status["state"].text() << ", step "
              << status["step"].number() << ", dt " << status["step_s"].number() << " s" << std::endl;
    for (const Json& robot : status["robots"].items()) {
      const std::string& owner = robot["owner"].text();
      std::cout << "ok    robot: " << robot["name"].text() << ", "
                << (owner.empty() ? "free" : "driven by " + owner) << std::endl;
    }
    for (const Awaited& a : sim.waiting()) {
      std::cout << "ok    waiting for " << a.robot << " (" << a.why << "), " << a.seconds << " s"
                << std::endl;
    }
    sim.close();
    return true;
  } catch (const Error& e) {
    std::cout << "FAIL  " << e.what() << std::endl;
    return false;
  }
}

bool doctor(const std::string& server, const std::string& token) {
  return doctor(server, Options{.token = token});
}

}  // namespace coopdyn::client
