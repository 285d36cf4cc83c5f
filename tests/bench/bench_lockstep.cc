// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/json.hpp>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "protocol/json_text.h"
#include "server/app/commands.h"
#include "server/app/options.h"
#include "tests/bench/bench_arena.h"
#include "tests/bench/bench_clients.h"
#include "tests/bench/bench_commands.h"
#include "tests/bench/bench_daemon.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/measures.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr double kStep_s = 0.01;
/// Without --rounds: this number of robot-rounds, within limits.
constexpr int kRobotRounds = 50'000, kFewestRounds = 30, kMostRounds = 5'000;
constexpr int kLeastWarmUp = 5;
constexpr const char* kWithRays = "bench_robot";  // the type with --rays

struct LockstepBench {
  int robots = 100;
  std::string robot = "minibot", fidelity = "rolling";
  int rays = 0;           // single rays all round instead of the robot's sensors; 0: its own sensors
  double range_m = 4;     // of those
  int robot_threads = 0;  // 0: the default
  int threads = 1;
  std::string record;  // recorded data; empty: none
  BenchClientOptions client;
  std::string clients = "per-robot", language = "cpp";
  int rounds = 0;  // 0: by the number of robots
  int repeats = 3;
  bool protocol_only = false;
  bool json = false;
};

/// Figures of one repeat; times per robot and round in µs.
struct LockstepFigures {
  double rounds_per_s = 0, us = 0, server_cpu_us = 0, client_cpu_us = 0;
};

std::string Contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The model of `robot`, its distance sensors replaced by single rays all round.
std::string ModelWithRays(const std::string& robot, int rays, double range_m) {
  std::string model;
  for (const fs::path& folder : DataPath({}).folders) {
    if (model.empty()) model = Contents(folder / "robots" / robot / "model.sdf");
  }
  constexpr std::string_view kBegin = "<coopdyn:distance_sensors", kEnd = "</coopdyn:distance_sensors>";
  const std::size_t begin = model.find(kBegin);
  const std::size_t end = model.find(kEnd);
  if (begin == std::string::npos || end == std::string::npos) {
    throw std::runtime_error("there is no robot " + robot +
                             " with distance sensors to replace: leave --rays out, or use --robot minibot");
  }
  const std::size_t radius = model.find("radius=\"", begin);
  const std::size_t height = model.find("height=\"", begin);
  const auto value = [&model, end](std::size_t at) {
    return at < end ? std::atof(model.c_str() + at + std::string_view("radius=\"").size()) : 0.05;
  };
  std::string sensors = fmt::format("{} radius=\"{}\" height=\"{}\" max_range=\"{}\" noise_stddev=\"0\">\n",
                                    kBegin, value(radius), value(height), range_m);
  for (int i = 0; i < rays; ++i) {
    sensors += fmt::format("<coopdyn:sector bearing_deg=\"{}\"/>\n", -180 + 360 * (i + 0.5) / rays);
  }
  return model.replace(begin, end - begin, sensors);
}

BenchDaemonOptions DaemonOf(const LockstepBench& options) {
  const double side_m = std::ceil(std::sqrt(options.robots));
  BenchDaemonOptions daemon;
  if (options.rays > 0) {
    daemon.files[fmt::format("robots/{}/model.sdf", kWithRays)] =
        ModelWithRays(options.robot, options.rays, options.range_m);
  }
  daemon.files["bench.scenario"] =
      "[SIMULATION]\nmode lockstep\n" + WalledSquare(side_m, 0.3) +
      fmt::format("[SWARM_1]\ntype {}\nname bot\ncount {}\nfidelity {}\narea 0 0 {} {}\n",
                  options.rays > 0 ? kWithRays : options.robot, options.robots, options.fidelity, side_m,
                  side_m);
  daemon.words = {"--threads", std::to_string(options.threads)};
  if (options.robot_threads > 0) {
    daemon.words.insert(daemon.words.end(), {"--robot-threads", std::to_string(options.robot_threads)});
  }
  daemon.record = options.record;
  return daemon;
}

double MedianOf(const std::vector<LockstepFigures>& all, double LockstepFigures::*value) {
  std::vector<double> values;
  for (const LockstepFigures& figures : all) values.push_back(figures.*value);
  return Median(std::move(values));
}

double Rounded(double value) {
  return std::round(value * 1000) / 1000;
}

std::string Describe(const LockstepBench& options) {
  const std::string rays = options.rays > 0 ? fmt::format("{} rays of {} m", options.rays, options.range_m)
                           : options.client.batch ? "poses"
                                                  : "no readings";
  return fmt::format("{} {}, {}, {}; {} client{}, {}{}{}", options.robots, options.robot, options.fidelity,
                     rays, options.language, options.client.batch ? "" : " with one connection per robot",
                     options.client.batch ? "one team, " : "",
                     options.robot_threads > 0 ? fmt::format("{} robot threads", options.robot_threads)
                                               : "threads by default",
                     options.record.empty() ? "" : ", recorded: " + options.record);
}

std::string Table(const LockstepBench& options, const LockstepFigures& median, const std::string& hash) {
  std::string table = Describe(options) + "\n" +
                      fmt::format("{} rounds, median of {}\n", options.client.rounds, options.repeats);
  const auto row = [&table](const char* name, const std::string& value) {
    table += fmt::format("  {:<32}{:>16}\n", name, value);
  };
  row("rounds per second", fmt::format("{:.0f}", median.rounds_per_s));
  row("robot-rounds per second", fmt::format("{:.0f}", median.rounds_per_s * options.robots));
  row("real-time factor", fmt::format("{:.2f}", median.rounds_per_s * kStep_s));
  row("us per robot-round", fmt::format("{:.2f}", median.us));
  row("  CPU of the daemon", fmt::format("{:.2f}", median.server_cpu_us));
  row("  CPU of the client", fmt::format("{:.2f}", median.client_cpu_us));
  row("state hash", hash);
  return table;
}

std::string Json(const LockstepBench& options, const LockstepFigures& median, const std::string& hash) {
  return JsonText(
             boost::json::object{{"robots", options.robots},
                                 {"robot", options.robot},
                                 {"clients", options.clients},
                                 {"language", options.language},
                                 {"fidelity", options.fidelity},
                                 {"rays", options.rays},
                                 {"protocol_only", options.protocol_only},
                                 {"robot_threads", options.robot_threads},
                                 {"threads", options.threads},
                                 {"record", options.record},
                                 {"rounds", options.client.rounds},
                                 {"repeats", options.repeats},
                                 {"rounds_per_s", Rounded(median.rounds_per_s)},
                                 {"robot_rounds_per_s", std::round(median.rounds_per_s * options.robots)},
                                 {"rtf", Rounded(median.rounds_per_s * kStep_s)},
                                 {"us_per_robot_round", Rounded(median.us)},
                                 {"server_cpu_us_per_robot_round", Rounded(median.server_cpu_us)},
                                 {"client_cpu_us_per_robot_round", Rounded(median.client_cpu_us)},
                                 {"hash", hash}}) +
         "\n";
}

int Run(const LockstepBench& options) {
  const double robot_rounds = static_cast<double>(options.client.rounds) * options.robots;
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  std::vector<LockstepFigures> all;
  std::string hash;
  for (int repeat = 1; repeat <= options.repeats; ++repeat) {
    if (terminal) std::cerr << fmt::format("\rrepeat {} of {} ", repeat, options.repeats) << std::flush;
    const BenchDaemon daemon(DaemonOf(options));
    const BenchClientFigures took = DriveBench(daemon, options.client);
    if (terminal) std::cerr << "\r\033[K";
    if (!hash.empty() && hash != took.hash) {
      std::cerr << "coopdyn bench lockstep: the repeats ended in different states, " << hash << " and "
                << took.hash << "; the same commands must give the same hash, so please report this\n";
      return kExitErrors;
    }
    hash = took.hash;
    all.push_back({.rounds_per_s = options.client.rounds / took.wall_s,
                   .us = took.wall_s * 1e6 / robot_rounds,
                   .server_cpu_us = took.server_cpu_s * 1e6 / robot_rounds,
                   .client_cpu_us = took.client_cpu_s * 1e6 / robot_rounds});
  }
  const LockstepFigures median{.rounds_per_s = MedianOf(all, &LockstepFigures::rounds_per_s),
                               .us = MedianOf(all, &LockstepFigures::us),
                               .server_cpu_us = MedianOf(all, &LockstepFigures::server_cpu_us),
                               .client_cpu_us = MedianOf(all, &LockstepFigures::client_cpu_us)};
  std::cout << (options.json ? Json(options, median, hash) : Table(options, median, hash)) << std::flush;
  return kExitOk;
}

int Measure(LockstepBench options, bool rays_given) {
  options.client.batch = options.clients == "batch";
  options.client.python = options.language == "python";
  if (options.protocol_only && (!options.client.batch || rays_given)) {
    std::cerr << "coopdyn bench lockstep: --protocol-only is for --clients batch without --rays\n";
    return kExitWrongUse;
  }
  if (options.protocol_only) options.fidelity = "planar";
  options.client.robots = options.robots;
  options.client.readings = options.rays > 0;
  options.client.at_rest = options.protocol_only;
  options.client.rounds = options.rounds > 0
                              ? options.rounds
                              : std::clamp(kRobotRounds / options.robots, kFewestRounds, kMostRounds);
  options.client.warm_up = std::max(kLeastWarmUp, options.client.rounds / 10);
  try {
    return Run(options);
  } catch (const std::exception& error) {
    std::cerr << "coopdyn bench lockstep: " << error.what() << '\n';
    return kExitErrors;
  }
}

}  // namespace

void AddBenchLockstep(CLI::App& bench, std::function<int()>& chosen) {
  // The parser writes into it while the command lives.
  const auto options = std::make_shared<LockstepBench>();
  CLI::App* sub = bench.add_subcommand("lockstep", "Lockstep rounds per second over sockets");
  sub->footer(
      "Example: coopdyn bench lockstep --robots 1000 --clients batch --rays 11\n"
      "A round: every robot gets its command, the step runs, every reply has come. Daemon and client are\n"
      "processes of their own; their start and a tenth of the rounds before the first measured one do not "
      "count.");
  sub->add_option("--robots", options->robots, "How many, one to the square metre")
      ->check(WholeIn(1, 20000))
      ->capture_default_str();
  sub->add_option("--robot", options->robot, "Their type: a folder of robots/")->capture_default_str();
  sub->add_option("--clients", options->clients, "per-robot: a connection each; batch: one team on /swarm")
      ->check(OneOf({"per-robot", "batch"}))
      ->capture_default_str();
  sub->add_option("--language", options->language, "Of the client: cpp or python")
      ->check(OneOf({"cpp", "python"}))
      ->capture_default_str();
  sub->add_option(
         "--rays", options->rays,
         "Number of single rays all round whose distances are read each round; 0: none, a team its poses")
      ->check(WholeIn(0, 360));
  sub->add_option("--range", options->range_m, "Range of the rays, m")
      ->check(NumberIn(0.001, 1000))
      ->capture_default_str();
  sub->add_option("--fidelity", options->fidelity, "full, rolling or planar")
      ->check(OneOf({"full", "rolling", "planar"}))
      ->capture_default_str();
  sub->add_flag("--protocol-only", options->protocol_only,
                "A team at rest, planar, that reads its poses: the step costs next to nothing");
  sub->add_option("--robot-threads", options->robot_threads, "Threads for the robots' connections")
      ->check(WholeIn(1, 10000));
  sub->add_option("--threads", options->threads, "Threads of sensing and physics")
      ->check(WholeIn(1, 256))
      ->capture_default_str();
  sub->add_option("--record", options->record, "Record the run, with so much: poses, or as --record-what");
  sub->add_option("--rounds", options->rounds, "Measured rounds of each repeat (default: 50,000 by robots)")
      ->check(WholeIn(1, 10'000'000));
  sub->add_option("--repeats", options->repeats, "Runs of which the median is told")
      ->check(WholeIn(1, 1000))
      ->capture_default_str();
  sub->add_flag("--json", options->json, "Print one JSON object instead of a table");
  sub->callback([sub, options, &chosen] {
    const bool rays = sub->get_option("--rays")->count() > 0;
    chosen = [options, rays] { return Measure(*options, rays); };
  });
}

}  // namespace coopdyn
