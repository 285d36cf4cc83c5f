// SPDX-License-Identifier: MIT
// Random runs in lockstep give the same hash in each step, for any order of commands, and any number of
// clients and stepping threads.
#include <algorithm>
#include <iterator>
#include <numeric>
#include <random>
#include <span>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "server/base/sanitizers.h"
#include "tests/server/physics/stepper_boards.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kRuns = 50;  // ten times slower
#else
constexpr int kRuns = 1000;
#endif
constexpr int kRunSteps = 30, kHeldSteps = 15;  // a command is held long enough that robots meet

/// A crowd of robots and boxes close to each other. One run in 25 has enough separate robots that the engine
/// distributes their islands to threads, one in 500 enough that it distributes every loop.
struct RandomRun {
  explicit RandomRun(unsigned number)
      : random(number),
        crowd(2 + static_cast<int>(random() % 7)),
        apart(number % 500 == 0  ? 520
              : number % 25 == 0 ? 40
                                 : 0),
        robots(crowd + apart) {
    constexpr const char* kFidelities[] = {"full", "rolling", "planar"};
    std::vector<int> cells(16);
    std::iota(cells.begin(), cells.end(), 0);
    std::ranges::shuffle(cells, random);
    const int things = crowd + static_cast<int>(random() % 4);
    for (int i = 0; i < things; ++i) {
      const auto cell = static_cast<std::size_t>(i);
      const double x_m = 0.2 * (cells[cell] % 4) + Number(-0.01, 0.01);
      const double y_m = 0.2 * (cells[cell] / 4) + Number(-0.01, 0.01);
      if (i < crowd) {
        AddRobot(i + 1, x_m, y_m, kFidelities[random() % 3]);
      } else {
        text += fmt::format("[BOX_{}]\ntype box\nsize 0.1 0.1 0.1\nposition {} {}\nmass 0.5\n", i - crowd + 1,
                            x_m, y_m);
      }
    }
    for (int i = 0; i < apart; ++i) {
      AddRobot(crowd + i + 1, 2 + 0.4 * (i % 20), 0.4 * (i / 20), apart > 100 ? "rolling" : "full");
    }
    for (int i = 0; i < kRunSteps / kHeldSteps * robots; ++i)
      commands.push_back({Number(-20, 20), Number(-20, 20)});
  }

  void AddRobot(int number, double x_m, double y_m, const char* fidelity) {
    text += fmt::format("[ROBOT_{}]\ntype minibot\nposition {} {}\norientation {}\nfidelity {}\n", number,
                        x_m, y_m, Number(-3, 3), fidelity);
  }
  double Number(double low, double high) { return std::uniform_real_distribution(low, high)(random); }
  const WheelSpeeds& CommandOf(int step, std::size_t robot) const {
    return commands[static_cast<std::size_t>(step / kHeldSteps * robots) + robot];
  }

  std::mt19937 random;
  int crowd, apart, robots;
  std::string text;
  std::vector<WheelSpeeds> commands;  // by time, then robot
};

enum class Clients { kOneEach, kOneEachOnTwoThreads, kTeam, kTeamAndOthers };

class RandomRunsTest : public StepperBoards {
 protected:
  /// The hash of each step, and the last frame in `end_`.
  std::vector<std::uint64_t> Run(RandomRun& run, Clients clients, WorkerPool* pool) {
    RunOptions options;
    options.mode = Mode::kLockstep;
    Doorbell bell;
    FrameBoard frames;
    CommandBoard board;
    EditQueue edits(bell);
    RunControl control;
    Stepper stepper({frames, board, edits, control, bell}, clock_, NullLogger(), options, {pool, nullptr});
    Diagnostics diagnostics;
    EXPECT_TRUE(stepper.Start(Read(run.text), diagnostics)) << run.text << diagnostics.ToString();
    const std::vector<SlotId> slots = board.FindSlots(*frames.Latest()->scene);
    const std::size_t in_team = clients == Clients::kTeam            ? slots.size()
                                : clients == Clients::kTeamAndOthers ? slots.size() / 2
                                                                     : 0;
    std::vector<std::size_t> order(slots.size() - in_team + (in_team > 0 ? 1 : 0));  // the team as its last
    std::iota(order.begin(), order.end(), in_team > 0 ? in_team - 1 : 0);
    const std::span<const std::size_t> all(order);
    std::vector<std::uint64_t> hashes;
    for (int step = 0; step < kRunSteps; ++step) {
      const auto send = [&](std::span<const std::size_t> robots) {
        for (const std::size_t robot : robots) {
          if (robot >= in_team) {
            const Client client{1 + robot, fmt::format("client{}", robot), "test"};
            board.Command(slots[robot], client, SetpointsFor(run.CommandOf(step, robot)), {}, Ignore);
            continue;
          }
          std::vector<Setpoint> setpoints;
          for (std::size_t i = 0; i < in_team; ++i) {
            std::ranges::copy(SetpointsFor(run.CommandOf(step, i)), std::back_inserter(setpoints));
          }
          Client client{100000, "team", "test"};
          client.is_team = true;
          board.StepAll({std::span(slots).first(in_team), setpoints}, client, 1, Ignore);
        }
      };
      std::ranges::shuffle(order, run.random);
      if (clients == Clients::kOneEachOnTwoThreads) {
        const std::jthread other(send, all.subspan(all.size() / 2));
        send(all.first(all.size() / 2));
      } else {
        send(all);
      }
      EXPECT_EQ(frames.Latest()->step, static_cast<std::uint64_t>(step) + 1);
      hashes.push_back(StateHash(*frames.Latest()));
    }
    end_ = frames.Latest();
    return hashes;
  }

  static void Ignore(const StepResult&) {}

  SteadyClock clock_;
  FramePtr end_;
};

TEST_F(RandomRunsTest, AnyOrderClientsAndThreadsGiveTheSameHashes) {
  WorkerPool pool(2);
  for (unsigned number = 1; number <= kRuns; ++number) {
    RandomRun run(number);
    const std::vector<std::uint64_t> hashes = Run(run, Clients::kOneEach, nullptr);
    ASSERT_EQ(Run(run, Clients::kTeam, &pool), hashes) << run.text;
    ASSERT_EQ(Run(run, Clients::kTeamAndOthers, nullptr), hashes) << run.text;
    ASSERT_EQ(Run(run, Clients::kOneEachOnTwoThreads, &pool), hashes) << run.text;
  }
}

TEST_F(RandomRunsTest, TheirRobotsPushEachOther) {
  // Otherwise the equal hashes would prove little: another command for one robot must change the end.
  int pushing = 0;
  for (unsigned number = 1; number <= 20; ++number) {
    RandomRun run(number);
    Run(run, Clients::kOneEach, nullptr);
    const FramePtr end = end_;
    for (std::size_t i = 0; i < run.commands.size(); i += static_cast<std::size_t>(run.robots)) {
      run.commands[i] = {0, 0};
    }
    Run(run, Clients::kOneEach, nullptr);
    bool others_moved = false;
    for (int i = 1; i < run.robots; ++i) {
      others_moved = others_moved || RobotPose(*end, i).p != RobotPose(*end_, i).p;
    }
    pushing += others_moved ? 1 : 0;
  }
  EXPECT_GT(pushing, 5);
}

}  // namespace
}  // namespace coopdyn
