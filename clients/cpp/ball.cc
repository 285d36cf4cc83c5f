// SPDX-License-Identifier: MIT
// Follows a red ball by a camera: client_ball [robot1 [SECONDS]]
//
// Scenario `ball`. The ball's pixels are those with much more red than green and blue. Their centre gives the
// bearing, their number n the distance: a ball of radius R at distance d covers pi (f R / d)^2 pixels, so
// d = f R sqrt(pi / n). The robot turns towards the ball and keeps its distance; without a ball in view it
// turns to the side where it saw the ball last. All three languages use the same algorithm and numbers.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>

#include "clients/cpp/coopdyn_client.h"

namespace {

namespace client = coopdyn::client;

constexpr double kBallRadius_m = 0.12;  // R
constexpr double kKeep_m = 0.8;         // from the camera to the ball
constexpr double kApproach = 1.0;       // 1/s, speed per metre of distance error
constexpr double kMaxSpeed = 0.4;       // m/s
constexpr double kSteer = 2.0;          // 1/s, turn rate per radian of bearing
constexpr double kMaxTurn = 1.5;        // rad/s
constexpr double kSearch = 0.8;         // rad/s, without a ball in view
constexpr double kRed = 60;             // minimal red of a red pixel
constexpr double kMore = 2;             // minimal ratio of red to green, and of red to blue
constexpr double kColumns = 80;         // sampled columns: every fourth pixel of a picture 320 wide
constexpr double kFew = 6;              // fewer red pixels are no ball

struct Ball {
  double distance, bearing;
};

/// Bearing and distance of the ball; nullopt if not in view.
std::optional<Ball> Look(const client::Image& image, const client::Camera& camera) {
  const int every = std::max(1, image.width / static_cast<int>(kColumns));
  double count = 0, columns = 0;
  for (int y = 0; y < image.height; y += every) {
    for (int x = 0; x < image.width; x += every) {
      const client::Rgb c = image.rgb(x, y);
      if (c.r < kRed || c.r < kMore * c.g || c.r < kMore * c.b) continue;
      ++count;
      const int column = x / every;
      columns += column;
    }
  }
  if (count < kFew) return std::nullopt;
  const double middle = every * columns / count + 0.5;
  return Ball{camera.fx * kBallRadius_m * std::sqrt(std::numbers::pi / count) / every,
              std::atan2(camera.cx - middle, camera.fx)};
}

int Run(const std::string& name, double duration) {
  client::Simulation sim = client::connect();
  client::Robot r = sim.robot(name);
  const client::Camera camera = r.get_camera();
  const double start = sim.time();
  double side = 1;
  int seen = 0, pictures = 0;
  Ball last{HUGE_VAL, 0};
  while (sim.time() - start < duration) {
    const std::optional<Ball> ball = Look(r.get_image(), camera);
    ++pictures;
    if (!ball) {
      r.set_velocity(0, kSearch * side);
    } else {
      ++seen;
      last = *ball;
      side = ball->bearing < 0 ? -1 : 1;
      r.set_velocity(std::clamp(kApproach * (ball->distance - kKeep_m), -kMaxSpeed, kMaxSpeed),
                     std::clamp(kSteer * ball->bearing, -kMaxTurn, kMaxTurn));
    }
    sim.step();
  }
  std::printf("%s saw the ball in %.0f %% of %d pictures, at last %.3f m away and %.2f degrees to the left\n",
              name.c_str(), 100.0 * seen / pictures, pictures, last.distance,
              last.bearing * 180 / std::numbers::pi);
  sim.close();
  return seen > 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
  return Run(argc > 1 ? argv[1] : "robot1", argc > 2 ? std::stod(argv[2]) : 30);
} catch (const client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
