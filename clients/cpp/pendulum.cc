// SPDX-License-Identifier: MIT
// Balances a two-wheeled robot by its IMU and drives it one metre forward: client_pendulum [robot1]
//
// Scenario `pendulum`. A state feedback sets the torque of the wheels' motors,
//
//   tau = kx (x - x_ref) + kv (v - v_ref) + kp pitch + kr rate,
//
// with the pitch and its rate from the IMU, and the travelled distance x and its speed v from the wheels'
// joints, which turn relative to the body. The gains are those of a linear-quadratic regulator for the
// robot's masses. At the start the robot leans on a skid, and gets up. All three languages use the same
// algorithm and numbers.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "clients/cpp/coopdyn_client.h"

namespace {

namespace client = coopdyn::client;

constexpr double kWheelRadius_m = 0.05;
constexpr double kPositionGain = 0.27;  // kx, N m/m
constexpr double kSpeedGain = 0.36;     // kv, N m s/m
constexpr double kPitchGain = 2.12;     // kp, N m/rad
constexpr double kRateGain = 0.24;      // kr, N m s/rad
constexpr double kMaxTorque = 1.0;      // N m, both wheels together
constexpr double kSpeed = 0.25;         // m/s
constexpr double kStandUntil_s = 4.0;   // simulated, from the start of the program
constexpr double kDriveUntil_s = 8.0;
constexpr double kEnd_s = 14.0;

int Run(const std::string& name) {
  client::Simulation sim = client::connect();
  client::Robot r = sim.robot(name);
  client::Joints wheels = r.joints("wheels");
  const double start = sim.time();
  client::Reading s = r.sense();
  const auto mean = [](const std::vector<double>& both) { return (both.at(0) + both.at(1)) / 2; };
  const double before = mean(s.joints["wheels"].position);
  double last = s.time, reference = 0, way = 0, most = 0;
  while (s.time - start < kEnd_s) {
    const double t = s.time - start;
    const client::Imu imu = s.imu.value();
    const double pitch = std::asin(std::clamp(2 * (imu.qw * imu.qy - imu.qz * imu.qx), -1.0, 1.0));
    way = kWheelRadius_m * (mean(s.joints["wheels"].position) - before + pitch);
    const double speed = kWheelRadius_m * (mean(s.joints["wheels"].velocity) + imu.wy);
    const double speed_reference = t >= kStandUntil_s && t < kDriveUntil_s ? kSpeed : 0;
    reference += speed_reference * (s.time - last);
    last = s.time;
    const double torque = kPositionGain * (way - reference) + kSpeedGain * (speed - speed_reference) +
                          kPitchGain * pitch + kRateGain * imu.wy;
    wheels.set_efforts({std::clamp(torque, -kMaxTorque, kMaxTorque) / 2});
    if (t >= kStandUntil_s) most = std::max(most, std::abs(pitch));
    sim.step();
    s = r.sense();
  }
  std::printf("%s went %.3f m and leaned at most %.2f degrees after it had got up\n", name.c_str(), way,
              most * 180 / std::numbers::pi);
  sim.close();
  return most < 0.2 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
  return Run(argc > 1 ? argv[1] : "robot1");
} catch (const client::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
