// SPDX-License-Identifier: MIT
#include "tests/bench/bench_robot.h"

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <array>
#include <boost/json.hpp>
#include <iostream>
#include <memory>
#include <utility>

#include "protocol/json_text.h"
#include "server/app/commands.h"
#include "server/app/options.h"
#include "tests/bench/bench_commands.h"

namespace coopdyn {

namespace {

/// Motions of the shipped robots, slow enough that they stay clear of each other for a minute.
constexpr std::array<std::pair<const char*, const char*>, 7> kUsual = {{{"quadruped", "trot speed=0.05"},
                                                                        {"hexapod", "tripod speed=0.05"},
                                                                        {"humanoid", "squat"},
                                                                        {"lwa", "reach"},
                                                                        {"irb120", "reach"},
                                                                        {"mh5", "reach"},
                                                                        {"mobile_arm", "reach z=0.6"}}};

/// µs of each phase of a step, all copies together.
BenchSplit StepSplit(const SwarmBenchOptions& options, const BenchSplit& of) {
  const double copies = options.arena.robots;
  return {copies * of.sense_us, copies * of.control_us, copies * of.physics_us, copies * of.publish_us,
          copies * of.other_us};
}

double StepTime_us(const BenchSplit& split) {
  return split.sense_us + split.control_us + split.physics_us + split.publish_us + split.other_us;
}

int RunRobotCommand(const SwarmBenchOptions& options, const std::vector<std::string>& folders, bool json) {
  RobotLibrary library(DataPath(folders));
  Diagnostics diagnostics;
  const auto result = RunSwarmBench(options, library, diagnostics);
  if (!result) {
    for (const Diagnostic& one : diagnostics.all()) {
      if (one.level == Diagnostic::Level::kError) std::cerr << "coopdyn bench robot: " << one.text << '\n';
    }
    return kExitErrors;
  }
  std::cout << (json ? RobotBenchJson(options, *result) : RobotBenchTable(options, *result)) << std::flush;
  for (const std::string& problem : result->problems) std::cerr << "coopdyn bench robot: " << problem << '\n';
  if (!result->hashes_agree()) {
    std::cerr << "coopdyn bench robot: the repeats ended in different states; the same seed must give the "
                 "same hash, so please report this\n";
    return kExitErrors;
  }
  if (!result->frozen.empty()) return kExitFaulty;
  return result->problems.empty() ? kExitOk : kExitErrors;
}

}  // namespace

SwarmBenchOptions RobotBenchOptions(const std::string& type, int copies, const std::string& controller) {
  constexpr double kSpacing_m = 4;
  SwarmBenchOptions options;
  options.arena.robots = copies;
  options.arena.robot = type;
  options.arena.fidelity = Fidelity::kFull;
  options.arena.walls = false;
  options.arena.density_m2 = 1 / (4 * kSpacing_m * kSpacing_m);
  options.arena.spacing_m = kSpacing_m;
  options.controllers_in_process = true;
  options.arena.controller = controller;
  if (controller == "none") options.arena.controller = "";
  if (!controller.empty()) return options;
  for (const auto& [robot, usual] : kUsual) {
    if (robot == type) options.arena.controller = usual;
  }
  return options;
}

std::string RobotBenchJson(const SwarmBenchOptions& options, const SwarmBenchResult& result) {
  const BenchSplit split = StepSplit(options, result.median.split);
  return JsonText(boost::json::object{
             {"robot", options.arena.robot},
             {"copies", options.arena.robots},
             {"controller", options.arena.controller.empty() ? "none" : options.arena.controller},
             {"threads", options.threads},
             {"seconds", options.seconds},
             {"repeats", options.repeats},
             {"steps", result.steps},
             {"step_us", StepTime_us(split)},
             {"rtf", result.median.rtf},
             {"spread", result.spread},
             {"kb_per_copy", result.kb_per_robot},
             {"split", boost::json::object{{"sense", split.sense_us},
                                           {"control", split.control_us},
                                           {"physics", split.physics_us},
                                           {"publish", split.publish_us},
                                           {"other", split.other_us}}},
             {"hash", result.hashes.back()}}) +
         "\n";
}

std::string RobotBenchTable(const SwarmBenchOptions& options, const SwarmBenchResult& result) {
  const BenchSplit split = StepSplit(options, result.median.split);
  const std::string& controller = options.arena.controller;
  std::string table = fmt::format(
      "{} {}, full, controller {}, in-process\n"
      "{} simulated seconds ({} steps), {} thread{}, median of {}\n",
      options.arena.robots, options.arena.robot, controller.empty() ? "none" : controller, options.seconds,
      result.steps, options.threads, options.threads == 1 ? "" : "s", options.repeats);
  const auto row = [&table](const std::string& name, const std::string& value) {
    table += fmt::format("  {:<32}{:>16}\n", name, value);
  };
  row("us per step", fmt::format("{:.1f}", StepTime_us(split)));
  row("real-time factor", fmt::format("{:.1f}", result.median.rtf));
  row("spread of the repeats", fmt::format("{:.1f} %", 100 * result.spread));
  row("kB per copy", fmt::format("{:.1f}", result.kb_per_robot));
  row("state hash", result.hashes.back());
  table += fmt::format(
      "  us of a step: sense {:.2f}  control {:.2f}  physics {:.2f}  publish {:.2f}  other {:.2f}\n",
      split.sense_us, split.control_us, split.physics_us, split.publish_us, split.other_us);
  return table;
}

void AddBenchRobot(CLI::App& bench, std::function<int()>& chosen) {
  struct Given {
    std::string type, controller;
    int copies = 1, threads = 1, repeats = 3;
    double seconds = 10;
    std::vector<std::string> folders;
    bool json = false;
  };
  // The parser writes into it while the command lives.
  const auto given = std::make_shared<Given>();
  CLI::App* sub =
      bench.add_subcommand("robot", "Time of a step, by phase, of one type of robot; memory of a copy");
  sub->footer("Example: coopdyn bench robot quadruped --copies 100");
  sub->add_option("type", given->type, "A folder of robots/")->required();
  sub->add_option("--copies", given->copies, "How many, 4 m from each other")
      ->check(WholeIn(1, 10000))
      ->capture_default_str();
  sub->add_option("--controller", given->controller,
                  "A loaded controller and its options instead of what the robot usually does; none: it "
                  "stands");
  sub->add_option("--threads", given->threads, "Threads of sensing, controllers and physics")
      ->check(WholeIn(1, 256))
      ->capture_default_str();
  constexpr double kMost_s = 1e6;
  sub->add_option("--seconds", given->seconds, "Simulated seconds of each repeat")
      ->check(NumberIn(0.01, kMost_s))
      ->capture_default_str();
  sub->add_option("--repeats", given->repeats, "Runs of which the median is told")
      ->check(WholeIn(1, 1000))
      ->capture_default_str();
  sub->add_option("--scenarios", given->folders, "A folder with robots and controllers");
  sub->add_flag("--json", given->json, "Print one JSON object instead of a table");
  sub->callback([given, &chosen] {
    SwarmBenchOptions options = RobotBenchOptions(given->type, given->copies, given->controller);
    options.threads = given->threads;
    options.seconds = given->seconds;
    options.repeats = given->repeats;
    chosen = [given, options] { return RunRobotCommand(options, given->folders, given->json); };
  });
}

}  // namespace coopdyn
