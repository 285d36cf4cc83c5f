// SPDX-License-Identifier: MIT
#include <algorithm>
#include <iostream>
#include <vector>

#include "clients/cpp/coopdyn_client.h"

namespace coopdyn::client {

bool doctor(const std::string& server, const std::string& token) {
  try {
    const Address address(server, "", token, 3);
    std::cout << "ok    server: " << address.text() << std::endl;
    address.DialTcp(After(address.timeout_s()));
    std::cout << "ok    port: " << address.port() << " is open" << std::endl;
    std::cout << "ok    names: " << address.Modules().size() << " modules; this client needs port "
              << address.port() << " only" << std::endl;
    Simulation sim = connect(server, {.token = token});
    const Json status = sim.status();
    std::cout << "ok    versions: daemon " << status["version"].text() << ", protocol "
              << status["protocol"].number() << std::endl;
    std::vector<double> took_s;
    for (int i = 0; i < 50; ++i) {
      const Deadline start = Clock::now();
      sim.mode();
      took_s.push_back(-Until(start));
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

}  // namespace coopdyn::client
