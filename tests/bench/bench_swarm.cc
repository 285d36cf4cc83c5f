// SPDX-License-Identifier: MIT
#include "tests/bench/bench_swarm.h"

#include <malloc.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/json.hpp>
#include <cmath>
#include <iostream>
#include <memory>

#include "protocol/json_text.h"
#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/state/frame.h"
#include "tests/bench/bench_commands.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/measures.h"

namespace coopdyn {

namespace {

BenchFigures FiguresOf(const BenchRun& run, int robots) {
  const double robot_steps = static_cast<double>(run.steps) * robots;
  constexpr double kTick_s = 1e-6;  // floor for runs too short for the kernel's clock
  const double cpu_s = std::max(run.cpu_s, kTick_s), wall_s = std::max(run.wall_s, kTick_s);
  const auto us = [robot_steps](double seconds) { return seconds * 1e6 / robot_steps; };
  const PhaseTimes& phases = run.phases;
  const Nanoseconds named = phases.sense + phases.control + phases.physics + phases.publish;
  return {.robot_steps_per_cpu_s = robot_steps / cpu_s,
          .robot_steps_per_wall_s = robot_steps / wall_s,
          .rtf = run.simulated_s / wall_s,
          .split = {.sense_us = us(ToSeconds(phases.sense)),
                    .control_us = us(ToSeconds(phases.control)),
                    .physics_us = us(ToSeconds(phases.physics)),
                    .publish_us = us(ToSeconds(phases.publish)),
                    .other_us = us(wall_s - ToSeconds(named))}};
}

BenchFigures MedianOf(const std::vector<BenchFigures>& all) {
  const auto median = [&all](auto value) {
    std::vector<double> values;
    for (const BenchFigures& figures : all) values.push_back(value(figures));
    return Median(std::move(values));
  };
  return {.robot_steps_per_cpu_s = median([](const auto& f) { return f.robot_steps_per_cpu_s; }),
          .robot_steps_per_wall_s = median([](const auto& f) { return f.robot_steps_per_wall_s; }),
          .rtf = median([](const auto& f) { return f.rtf; }),
          .split = {.sense_us = median([](const auto& f) { return f.split.sense_us; }),
                    .control_us = median([](const auto& f) { return f.split.control_us; }),
                    .physics_us = median([](const auto& f) { return f.split.physics_us; }),
                    .publish_us = median([](const auto& f) { return f.split.publish_us; }),
                    .other_us = median([](const auto& f) { return f.split.other_us; })}};
}

double SpreadOf(const std::vector<BenchFigures>& all) {
  std::vector<double> values;
  for (const BenchFigures& figures : all) values.push_back(figures.robot_steps_per_cpu_s);
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return (*most - *least) / Median(values);
}

/// 312 456 as "312,456".
std::string WithCommas(double value) {
  std::string text = fmt::format("{:.0f}", value);
  for (auto at = static_cast<std::ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) {
    text.insert(static_cast<std::size_t>(at), ",");
  }
  return text;
}

/// For JSON: with the significant digits.
double Rounded(double value, int digits) {
  if (value == 0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10, digits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

std::string CheckWhole(const std::string& text) {
  const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  return digits ? "" : "must be a whole number from 0, not " + text;
}

int RunCommand(const SwarmBenchOptions& options, const std::vector<std::string>& folders, bool json) {
  const SearchPath path = DataPath(folders);
  RobotLibrary library(path);
  Diagnostics diagnostics;
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  const auto result = RunSwarmBench(options, library, diagnostics, [&](int repeat) {
    if (terminal) std::cerr << fmt::format("\rrepeat {} of {} ", repeat, options.repeats) << std::flush;
  });
  if (terminal) std::cerr << "\r\033[K";
  if (!result) {
    for (const Diagnostic& one : diagnostics.all()) {
      if (one.level == Diagnostic::Level::kError) std::cerr << "coopdyn bench swarm: " << one.text << '\n';
    }
    return kExitErrors;
  }
  std::cout << (json ? BenchJson(options, *result) : BenchTable(options, *result)) << std::flush;
  for (const std::string& problem : result->problems) std::cerr << "coopdyn bench swarm: " << problem << '\n';
  if (!result->hashes_agree()) {
    std::string hashes;
    for (const std::string& hash : result->hashes) hashes += " " + hash;
    std::cerr << "coopdyn bench swarm: the repeats ended in different states:" << hashes
              << "; the same seed must give the same hash, so please report this\n";
    return kExitErrors;
  }
  if (!result->frozen.empty()) return kExitFaulty;
  return result->problems.empty() ? kExitOk : kExitErrors;
}

}  // namespace

bool SwarmBenchResult::hashes_agree() const {
  return std::adjacent_find(hashes.begin(), hashes.end(), std::not_equal_to<>()) == hashes.end();
}

std::optional<SwarmBenchResult> RunSwarmBench(const SwarmBenchOptions& options, RobotLibrary& library,
                                              Diagnostics& diagnostics,
                                              const std::function<void(int)>& tell) {
  // Memory that does not depend on the number of robots: code, and the robot's model.
  if (library.Get(options.arena.robot, {}, diagnostics) == nullptr) return std::nullopt;
  ::malloc_trim(0);
  const double resident_before_kb = Resident_kb();
  const auto scenario = MakeArena(options.arena, library, diagnostics);
  if (scenario == nullptr) return std::nullopt;
  const std::vector<SectorModel> sensors = scenario->robots.front().model->sectors();
  SwarmBenchResult result;
  for (const SectorModel& sensor : sensors) result.rays += sensor.rays;
  if (!sensors.empty()) result.range_m = sensors.front().max_range_m;
  BenchRunOptions run_options{.seconds = options.seconds,
                              .threads = options.threads,
                              .controllers_in_process = options.controllers_in_process,
                              .program = options.program,
                              .sense = options.arena.controller.empty() && !sensors.empty()};
  std::vector<BenchFigures> all;
  for (int repeat = 1; repeat <= options.repeats; ++repeat) {
    if (tell) tell(repeat);
    const std::optional<BenchRun> run = RunOnce(scenario, run_options, diagnostics);
    if (!run) return std::nullopt;
    // Later repeats reuse the memory of the first.
    if (repeat == 1) result.kb_per_robot = (run->resident_kb - resident_before_kb) / options.arena.robots;
    result.steps = run->steps;
    result.hashes.push_back(HashText(run->hash));
    result.frozen.insert(result.frozen.end(), run->frozen.begin(), run->frozen.end());
    result.problems.insert(result.problems.end(), run->problems.begin(), run->problems.end());
    all.push_back(FiguresOf(*run, options.arena.robots));
  }
  result.median = MedianOf(all);
  result.spread = SpreadOf(all);
  return result;
}

std::string BenchJson(const SwarmBenchOptions& options, const SwarmBenchResult& result) {
  const ArenaOptions& arena = options.arena;
  const BenchFigures& median = result.median;
  const BenchSplit& split = median.split;
  return JsonText(
             boost::json::object{{"robots", arena.robots},
                                 {"robot", arena.robot},
                                 {"rays", result.rays},
                                 {"range", result.range_m},
                                 {"fidelity", ToString(arena.fidelity)},
                                 {"controller", arena.controller.empty() ? "none" : arena.controller},
                                 {"controllers", options.controllers_in_process ? "in-process" : "child"},
                                 {"density", arena.density_m2},
                                 {"boxes", arena.boxes},
                                 {"threads", options.threads},
                                 {"seed", arena.seed},
                                 {"seconds", options.seconds},
                                 {"repeats", options.repeats},
                                 {"steps", result.steps},
                                 {"robot_steps_per_cpu_s", std::llround(median.robot_steps_per_cpu_s)},
                                 {"robot_steps_per_wall_s", std::llround(median.robot_steps_per_wall_s)},
                                 {"spread", Rounded(result.spread, 3)},
                                 {"rtf", Rounded(median.rtf, 4)},
                                 {"kb_per_robot", Rounded(result.kb_per_robot, 4)},
                                 {"split", boost::json::object{{"sense", Rounded(split.sense_us, 4)},
                                                               {"control", Rounded(split.control_us, 4)},
                                                               {"physics", Rounded(split.physics_us, 4)},
                                                               {"publish", Rounded(split.publish_us, 4)},
                                                               {"other", Rounded(split.other_us, 4)}}},
                                 {"hash", result.hashes.back()}}) +
         "\n";
}

std::string BenchTable(const SwarmBenchOptions& options, const SwarmBenchResult& result) {
  const ArenaOptions& arena = options.arena;
  const BenchFigures& median = result.median;
  const std::string rays =
      result.rays == 0 ? "no rays" : fmt::format("{} rays of {} m", result.rays, result.range_m);
  std::string table = fmt::format(
      "{} {}, {}, {}, controller {}; {} to the square metre, seed {}\n"
      "{} simulated seconds ({} steps), {} thread{}, median of {}\n",
      arena.robots, arena.robot, ToString(arena.fidelity), rays,
      arena.controller.empty() ? "none" : arena.controller, arena.density_m2, arena.seed, options.seconds,
      result.steps, options.threads, options.threads == 1 ? "" : "s", options.repeats);
  const auto row = [&table](const std::string& name, const std::string& value) {
    table += fmt::format("  {:<32}{:>16}\n", name, value);
  };
  row("robot-steps per CPU second", WithCommas(median.robot_steps_per_cpu_s));
  row("robot-steps per second", WithCommas(median.robot_steps_per_wall_s));
  row("spread of the repeats", fmt::format("{:.1f} %", 100 * result.spread));
  row("real-time factor", fmt::format("{:.2f}", median.rtf));
  row("kB per robot", fmt::format("{:.1f}", result.kb_per_robot));
  row("state hash", result.hashes.back());
  table += "  us per robot-step: ";
  table += fmt::format("sense {:.3f}  control {:.3f}  physics {:.3f}  publish {:.3f}  other {:.3f}\n",
                       median.split.sense_us, median.split.control_us, median.split.physics_us,
                       median.split.publish_us, median.split.other_us);
  return table;
}

void AddBenchSwarm(CLI::App& bench, std::function<int()>& chosen) {
  struct Given {
    SwarmBenchOptions options;
    int rays = 0;
    double range_m = 0;
    std::string fidelity = "rolling", controller = "diffuse", controllers = "child";
    std::vector<std::string> folders;
    bool json = false;
  };
  // The parser writes into it while the command lives.
  const auto given = std::make_shared<Given>();
  CLI::App* sub =
      bench.add_subcommand("swarm", "Robot-steps per second of CPU, without sockets and pictures");
  sub->footer(
      "Example: coopdyn bench swarm --robots 1000 --rays 8 --range 0.1 --fidelity rolling --controller "
      "diffuse\n"
      "CPU time is that of all threads and of the controllers' process, from the first step to the last.");
  ArenaOptions& arena = given->options.arena;
  constexpr double kLeast = 1e-3, kMost = 1e6;
  sub->add_option("--robots", arena.robots, "How many")->check(WholeIn(1, 100000))->capture_default_str();
  sub->add_option("--robot", arena.robot, "Their type: a folder of robots/")->capture_default_str();
  sub->add_option("--rays", given->rays,
                  "So many single rays, evenly spread, instead of the robot's sensors; 0: none")
      ->check(WholeIn(0, 3600));
  sub->add_option("--range", given->range_m, "Range of the rays in m, instead of the robot's")
      ->check(NumberIn(kLeast, 1e5));
  sub->add_option("--fidelity", given->fidelity, "full, rolling or planar")
      ->check(OneOf({"full", "rolling", "planar"}))
      ->capture_default_str();
  sub->add_option(
         "--controller", given->controller,
         "A loaded controller and its options, e.g. \"diffuse speed=0.2\"; none: random wheel speeds, "
         "set once")
      ->capture_default_str();
  sub->add_option("--controllers", given->controllers, "Where they run: child or in-process")
      ->check(OneOf({"child", "in-process"}))
      ->capture_default_str();
  sub->add_option("--threads", given->options.threads, "Threads of sensing, controllers and physics")
      ->check(WholeIn(1, 256))
      ->capture_default_str();
  sub->add_option("--seconds", given->options.seconds, "Simulated seconds of each repeat")
      ->check(NumberIn(0.01, kMost))
      ->capture_default_str();
  sub->add_option("--repeats", given->options.repeats, "Runs of which the median is told")
      ->check(WholeIn(1, 1000))
      ->capture_default_str();
  sub->add_option("--density", arena.density_m2, "Robots per square metre")
      ->check(NumberIn(kLeast, 1000))
      ->capture_default_str();
  sub->add_option("--boxes", arena.boxes, "Boxes of 0.5 kg among the robots, which they push")
      ->check(WholeIn(0, 100000))
      ->capture_default_str();
  sub->add_option("--seed", arena.seed, "Of places, controllers and noise")
      ->check(CLI::Validator(CheckWhole, ""))
      ->capture_default_str();
  sub->add_option("--scenarios", given->folders, "A folder with robots and controllers");
  sub->add_flag("--json", given->json, "Print one JSON object instead of a table");
  sub->callback([sub, given, &chosen] {
    SwarmBenchOptions& options = given->options;
    if (sub->get_option("--rays")->count() > 0) options.arena.rays = given->rays;
    if (sub->get_option("--range")->count() > 0) options.arena.range_m = given->range_m;
    options.arena.fidelity = *ParseFidelity(given->fidelity);
    if (given->controller != "none") options.arena.controller = given->controller;
    options.controllers_in_process = given->controllers == "in-process";
    chosen = [given] { return RunCommand(given->options, given->folders, given->json); };
  });
}

}  // namespace coopdyn
