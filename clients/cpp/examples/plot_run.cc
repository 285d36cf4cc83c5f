// SPDX-License-Identifier: MIT
// Draws the path of a robot: client_plot_run lesson1.run robot1 > path.svg
#include <cstdio>

#include "clients/cpp/run_file.h"

int main(int argc, char** argv) try {
  if (argc != 3) throw coopdyn::client::Error(2, "write: client_plot_run NAME.run ROBOT > path.svg");
  const auto pose = coopdyn::client::read_run(argv[1]).pose(argv[2]);  // x, y [m], heading [rad]
  std::puts("<svg xmlns='http://www.w3.org/2000/svg' viewBox='-6 -6 12 12' width='600' height='600'>");
  std::puts("<polyline fill='none' stroke='crimson' stroke-width='0.03' points='");
  for (std::size_t i = 0; i < pose.size(); ++i) std::printf("%.4f,%.4f ", pose[i][0], -pose[i][1]);
  std::puts("'/></svg>");
} catch (const coopdyn::client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return argc == 3 ? 1 : 2;
}
