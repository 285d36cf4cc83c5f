// SPDX-License-Identifier: MIT
// Drives to the light and learns on the way to keep clear of things. Two eyes, the left one first, steer
// towards the lamp; their lowest reading is the ambient light. Reflexes avoid near things. Distance readings
// before a reflex predict it: each reflex increases their weights (input correlation learning, Porr and
// Woergoetter 2006), so the robot turns earlier each time until it needs no reflex. Logs the sum of the
// weights and the number of reflexes.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "cpp_controller.h"

namespace {

constexpr size_t kMostSensors = 32;

class Seeker {
 public:
  struct State {
    double weight[kMostSensors];
    double trace[kMostSensors];  // low-pass filtered readings
    double reflex[2];            // of the left and the right side, smoothed
    double around;               // ambient light
    double dark_s;               // time without a lamp in sight
    double side;                 // turning direction past things: 1 left, -1 right
    double reflexes;             // their number
    uint32_t is_near;            // 1: in a reflex
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"speed", "m/s", 0.25, 0, 5},
        {"steer", "turn to the light, rad/s", 2, 0, 20},
        {"avoid", "turn away from things, rad/s", 4, 0, 20},
        {"near", "distance of the reflex, m", 0.15, 0.01, 10},
        {"learn", "how much a reflex adds to the weights", 0.5, 0, 100},
    };
    static const coopdyn_description description = {"finds a lamp and learns to avoid things",
                                                    COOPDYN_DISTANCES | COOPDYN_SENSORS,
                                                    sizeof(State),
                                                    5,
                                                    options,
                                                    "light"};
    return &description;
  }

  Seeker(const coopdyn_robot& robot, const double* options)
      : robot_(robot),
        speed_m_s_(options[0]),
        steer_rad_s_(options[1]),
        avoid_rad_s_(options[2]),
        near_m_(options[3]),
        learn_(options[4]) {
    if (robot.sensor_count == 0 || robot.sensors[0].value_count < 2)
      throw std::runtime_error("the robot needs a light sensor of two eyes, the left one first");
    if (robot.distance_count == 0 || robot.distance_count > kMostSensors)
      throw std::runtime_error("the robot needs 1 to 32 distance sensors");
  }

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    if (readings.step == 0) {
      state.around = std::min(readings.sensors[0].values[0], readings.sensors[0].values[1]);
      state.side = coopdyn::Random(readings.seed, robot_.id, 0) < 0.5 ? 1 : -1;
    }
    double close[2];  // urgency to avoid things on the left and on the right, from 0 on
    Learn(readings, close);
    const double most = std::max(close[0], close[1]), wary = std::min(1.0, most);
    // Keep a chosen side until all is clear.
    if (most < 0.1) state.side = 0;
    if (state.side == 0 && most >= 0.1) state.side = close[0] > close[1] ? -1 : 1;
    const double light_rad_s = Light(readings.sensors[0].values, readings);
    command.turn_rad_s = (1 - wary) * light_rad_s + avoid_rad_s_ * wary * state.side;
    command.forward_m_s = speed_m_s_ * (1 - 0.9 * wary);
    double sum = 0;
    for (size_t i = 0; i < readings.distance_count; ++i) sum += state.weight[i];
    coopdyn_log(&command, "weights", sum);
    coopdyn_log(&command, "reflexes", state.reflexes);
  }

 private:
  /// Updates reflexes and weights; `close`: urgency by reflexes and weighted readings.
  void Learn(const coopdyn_readings& readings, double* close) {
    constexpr double kReflex_s = 0.05, kTrace_s = 0.5;
    double near[2] = {0, 0};
    for (size_t i = 0; i < readings.distance_count; ++i) {
      double& worst = near[SideOf(i)];
      worst = std::max(worst, 1 - readings.distance_m[i] / near_m_);
    }
    const bool is_near = std::max(near[0], near[1]) > 0;
    if (is_near && state.is_near == 0) state.reflexes += 1;
    state.is_near = is_near ? 1 : 0;
    double rise[2];
    for (size_t side = 0; side < 2; ++side) {
      const double before = state.reflex[side];
      state.reflex[side] += std::min(1.0, readings.step_s / kReflex_s) * (near[side] - before);
      rise[side] = std::max(0.0, state.reflex[side] - before);
      close[side] = std::min(1.0, 4 * near[side]);
    }
    for (size_t i = 0; i < readings.distance_count; ++i) {
      const size_t side = SideOf(i);
      const double sight = std::max(0.0, 1 - readings.distance_m[i] / robot_.distance_max_m[i]);
      state.trace[i] += std::min(1.0, readings.step_s / kTrace_s) * (sight - state.trace[i]);
      state.weight[i] += learn_ * rise[side] * state.trace[i];
      close[side] += state.weight[i] * sight * sight;
    }
  }

  size_t SideOf(size_t sensor) const { return robot_.distance_bearing_rad[sensor] > 0 ? 0 : 1; }

  /// The turn rate towards the lamp; without a lamp, searches.
  double Light(const double* eyes, const coopdyn_readings& readings) {
    constexpr double kForget_s = 60, kSeen = 0.002, kLook_s = 1.5;
    const double least = std::min(eyes[0], eyes[1]), sum = eyes[0] + eyes[1];
    state.around += (sum / 2 - state.around) * readings.step_s / kForget_s;
    state.around = std::min(state.around, least);
    const double shine = sum - 2 * state.around;
    if (shine > kSeen) {
      state.dark_s = 0;
      return steer_rad_s_ * std::clamp((eyes[0] - eyes[1]) / shine, -1.0, 1.0);
    }
    // Search: turn for a third of the time, else drive on.
    state.dark_s += readings.step_s;
    const auto look = static_cast<uint64_t>(state.dark_s / kLook_s);
    const double way = coopdyn::Random(readings.seed, robot_.id, look, 1);
    return look % 3 == 0 ? steer_rad_s_ * (way < 0.5 ? 1 : -1) : 0.2 * steer_rad_s_ * (way - 0.5);
  }

  const coopdyn_robot& robot_;
  const double speed_m_s_, steer_rad_s_, avoid_rad_s_, near_m_, learn_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Seeker>();
}
