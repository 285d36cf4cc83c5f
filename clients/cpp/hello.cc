// SPDX-License-Identifier: MIT
// Drives robot1 to the red target past obstacles. Runs unchanged in real time and in lockstep.
#include <algorithm>
#include <cstdio>

#include "clients/cpp/coopdyn_client.h"

int main() try {
  auto sim =
      coopdyn::client::connect();  // "labserver", "labserver:10100"; default: this machine, or COOPDYN_SERVER
  auto r = sim.robot("robot1");
  for (int k = 0; k < 2000; ++k) {
    const auto t = r.get_target("red");  // t.distance [m], t.bearing [rad], left is positive
    if (t.distance < 0.4) break;
    const auto d = r.get_distances();  // 11 ranges [m], right to left, inf = nothing there
    const double nearest = *std::min_element(d.begin(), d.end());
    const double right = *std::min_element(d.begin(), d.begin() + 5);
    r.set_velocity(0.3 * std::min(1.0, nearest), 1.5 * t.bearing + 0.4 * (right < 0.5));
    sim.step();
  }
  const auto p = r.get_pose();
  std::printf("%.2f %.2f at t = %.2f s\n", p.x, p.y, sim.time());
  sim.close();
} catch (const coopdyn::client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
