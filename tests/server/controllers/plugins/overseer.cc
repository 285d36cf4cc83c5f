// SPDX-License-Identifier: MIT
// A supervisor that does its `deed` in step `at`.
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "clients/plugin/cpp_controller.h"
#include "tests/server/controllers/plugins/deeds.h"

namespace {

using namespace coopdyn;

coopdyn_move* volatile moves_elsewhere = nullptr;
volatile int zero = 0;

class Overseer {
 public:
  struct State {
    std::uint64_t steps;
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {{"deed", "what it does", 0, 0, 1000},
                                             {"at", "in this step; -1: in every one", -1, -1, 1e9}};
    static const coopdyn_description description = {"oversees", COOPDYN_WORLD, sizeof(State), 2, options};
    return &description;
  }

  Overseer(const coopdyn_robot& /*none*/, const double* options)
      : deed_(static_cast<int>(options[0])), at_(options[1]) {}

  void Reset(std::uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    const auto step = static_cast<double>(state.steps++);
    if (at_ < 0 || at_ == step) Do(readings, command);
  }

 private:
  void Do(const coopdyn_readings& readings, coopdyn_command& command) const {
    const coopdyn_world& world = *readings.world;
    const coopdyn_body& first = world.bodies[0];
    const coopdyn_body* robot = coopdyn_find(&world, "robot1");
    switch (deed_) {
      case kWatches:
        coopdyn_log(&command, "bodies", static_cast<double>(world.body_count));
        coopdyn_log(&command, "scores", static_cast<double>(world.score_count));
        if (robot != nullptr) {
          coopdyn_log(&command, "x", robot->pose.p_m[0]);
          coopdyn_log(&command, "speed", std::hypot(robot->velocity_m_s[0], robot->velocity_m_s[1]));
        }
        break;
      case kMovesAll:
        for (std::size_t i = 0; i < world.body_count; ++i) {
          coopdyn_pose pose = world.bodies[i].pose;
          pose.p_m[0] += 1;
          coopdyn_put(&command, world.bodies[i].id, pose);
        }
        break;
      case kEndsRun:
        coopdyn_end_run(&command, "it is\nenough");
        break;
      case kMovesNobody:
        coopdyn_put(&command, 999, first.pose);
        break;
      case kMovesTwice:
        coopdyn_put(&command, robot->id, robot->pose);
        coopdyn_put(&command, robot->id, robot->pose);
        break;
      case kMovesInto:
        coopdyn_put(&command, robot->id, coopdyn_find(&world, "robot2")->pose);
        break;
      case kMovesTooMany:
        for (int i = 0; i <= COOPDYN_MAX_MOVES; ++i) coopdyn_put(&command, first.id, first.pose);
        break;
      case kMovesToNowhere:
        coopdyn_put(&command, first.id, {{std::nan(""), 0, 0}, {1, 0, 0, 0}});
        break;
      case kTurnsWrongly:
        coopdyn_put(&command, first.id, {{0, 0, 0}, {0, 0, 0, 0}});
        break;
      case kLogsTooMuch:
        for (int i = 0; i <= COOPDYN_MAX_LOGS; ++i) coopdyn_log(&command, "energy", i);
        break;
      case kLogsNotANumber:
        coopdyn_log(&command, "energy", std::nan(""));
        break;
      case kLogsUnderABadName:
        coopdyn_log(&command, "my energy", 1);
        break;
      case kLogsUnderALongName:
        coopdyn_log(&command, "energy", 1);
        for (char& c : command.logs[0].name) c = 'x';
        break;
      case kOtherSupervision:
        command.supervision = nullptr;
        break;
      case kOtherMoves:
        command.supervision->moves = moves_elsewhere;
        break;
      case kOtherLogs:
        command.logs = nullptr;
        break;
      case kWritesPastMoves:
        command.supervision->moves[COOPDYN_MAX_MOVES + zero] = {};
        break;
      case kWritesPastLogs:
        command.logs[COOPDYN_MAX_LOGS + zero] = {};
        break;
      case kWritesWorld:
        const_cast<coopdyn_body&>(first).id = 1;
        break;
      case kOverseerThrows:
        throw std::runtime_error("no whistle");
      case kOverseerCrashes:
        std::abort();
      case kOverseerHangs:
        while (zero == 0) {
        }
        break;
      default:
        break;
    }
  }

  const int deed_;
  const double at_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Overseer>();
}
