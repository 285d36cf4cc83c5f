// SPDX-License-Identifier: MIT
// A supervisor: the robots race to the scenario's first target. A robot that comes near enough wins the round
// and returns to its start; the target moves to another place. After the last round the run ends.
#include <cmath>

#include "cpp_controller.h"

namespace {

class Referee {
 public:
  static constexpr uint32_t kMostHomes = 64;
  struct State {
    uint32_t rounds, winner;  // rounds won; robot to send home, 0 while the round runs
    double began_s;           // when the round began
    double x_m, y_m;          // wanted position of the target
    uint32_t home_count;
    uint32_t robots[kMostHomes];
    coopdyn_pose homes[kMostHomes];  // start poses of these robots
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"rounds", "after so many the run ends", 5, 1, 1e6},
        {"reach", "so near to the target is there, m", 0.5, 0.01, 100},
        {"field", "the target comes to places at most so far from the origin in x and in y, m", 2, 0.1, 1000},
    };
    static const coopdyn_description description = {"a race: who reaches the target wins a round",
                                                    COOPDYN_WORLD, sizeof(State), 3, options};
    return &description;
  }

  Referee(const coopdyn_robot& /*none*/, const double* options)
      : rounds_(options[0]), reach_m_(options[1]), field_m_(options[2]) {}

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    const coopdyn_world& world = *readings.world;
    if (readings.step == 0) RememberHomes(world);
    const coopdyn_body* target = nullptr;
    for (size_t i = 0; i < world.body_count && target == nullptr; ++i) {
      if (world.bodies[i].kind == COOPDYN_TARGET) target = &world.bodies[i];
    }
    if (target == nullptr) return coopdyn_end_run(&command, "there is no target to race to");
    if (state.winner != 0) {
      const bool moved = target->pose.p_m[0] == state.x_m && target->pose.p_m[1] == state.y_m;
      // If something blocked the place, try another one.
      if (!moved) return BeginRound(readings, *target, command);
      state.winner = 0;
    }
    for (size_t i = 0; i < world.body_count; ++i) {
      const coopdyn_body& robot = world.bodies[i];
      const double x_m = robot.pose.p_m[0] - target->pose.p_m[0],
                   y_m = robot.pose.p_m[1] - target->pose.p_m[1];
      if (robot.kind != COOPDYN_ROBOT || coopdyn_hypot(x_m, y_m) > reach_m_) continue;
      ++state.rounds;
      coopdyn_log(&command, "round", state.rounds);
      coopdyn_log(&command, "round_time", readings.time_s - state.began_s);
      if (state.rounds >= rounds_) return coopdyn_end_run(&command, "the last round is won");
      state.began_s = readings.time_s;
      state.winner = robot.id;
      return BeginRound(readings, *target, command);
    }
  }

 private:
  void RememberHomes(const coopdyn_world& world) {
    for (size_t i = 0; i < world.body_count && state.home_count < kMostHomes; ++i) {
      if (world.bodies[i].kind != COOPDYN_ROBOT) continue;
      state.robots[state.home_count] = world.bodies[i].id;
      state.homes[state.home_count++] = world.bodies[i].pose;
    }
  }

  void BeginRound(const coopdyn_readings& readings, const coopdyn_body& target, coopdyn_command& command) {
    state.x_m = field_m_ * (2 * coopdyn::Random(readings.seed, 0, readings.step, 0) - 1);
    state.y_m = field_m_ * (2 * coopdyn::Random(readings.seed, 0, readings.step, 1) - 1);
    coopdyn_put(&command, target.id, {{state.x_m, state.y_m, target.pose.p_m[2]}, {1, 0, 0, 0}});
    for (uint32_t i = 0; i < state.home_count; ++i) {
      if (state.robots[i] == state.winner) coopdyn_put(&command, state.winner, state.homes[i]);
    }
  }

  const double rounds_, reach_m_, field_m_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Referee>();
}
