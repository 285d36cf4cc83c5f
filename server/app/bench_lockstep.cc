// SPDX-License-Identifier: MIT
#include "server/app/bench_lockstep.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/json.hpp>
#include <cmath>
#include <exception>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/app/bench_clients.h"
#include "server/app/bench_daemon.h"
#include "server/app/bench_run.h"
#include "server/app/commands.h"
#include "server/app/number_checks.h"

namespace coopdyn {

namespace {

constexpr double kStep_s = 0.01;
/// Without --rounds: this many robot-rounds, within limits.
constexpr int kRobotRounds = 50'000, kFewestRounds = 30, kMostRounds = 5'000;
constexpr int kLeastWarmUp = 5;

struct LockstepBench {
  BenchDaemonOptions daemon;
  BenchClientOptions client;
  std::string clients = "per-robot", language = "cpp";
  int rays = 0, robot_threads = 0;  // as given
  int rounds = 0;                   // 0: by the number of robots
  int repeats = 3;
  bool protocol_only = false;
  bool json = false;
};

/// Of one repeat; times per robot and round in µs.
struct LockstepFigures {
  double rounds_per_s = 0, us = 0, server_cpu_us = 0, client_cpu_us = 0;
};

double MedianOf(const std::vector<LockstepFigures>& all, double LockstepFigures::*value) {
  std::vector<double> values;
  for (const LockstepFigures& figures : all) values.push_back(figures.*value);
  return Median(std::move(values));
}

double Rounded(double value) {
  return std::round(value * 1000) / 1000;
}

std::string Describe(const LockstepBench& options) {
  const std::string rays = options.daemon.rays
                               ? fmt::format("{} rays of {} m", *options.daemon.rays, options.daemon.range_m)
                           : options.client.batch ? "poses"
                                                  : "no readings";
  return fmt::format(
      "{} {}, {}, {}; {} client{}, {}{}{}", options.daemon.robots, options.daemon.robot,
      options.daemon.fidelity, rays, options.language,
      options.client.batch ? "" : " with one connection per robot", options.client.batch ? "one team, " : "",
      options.daemon.robot_threads ? fmt::format("{} robot threads", *options.daemon.robot_threads)
                                   : "threads by default",
      options.daemon.record.empty() ? "" : ", recorded: " + options.daemon.record);
}

std::string Table(const LockstepBench& options, const LockstepFigures& median, const std::string& hash) {
  std::string table = Describe(options) + "\n" +
                      fmt::format("{} rounds, median of {}\n", options.client.rounds, options.repeats);
  const auto row = [&table](const char* name, const std::string& value) {
    table += fmt::format("  {:<32}{:>16}\n", name, value);
  };
  row("rounds per second", fmt::format("{:.0f}", median.rounds_per_s));
  row("robot-rounds per second", fmt::format("{:.0f}", median.rounds_per_s * options.daemon.robots));
  row("real-time factor", fmt::format("{:.2f}", median.rounds_per_s * kStep_s));
  row("us per robot-round", fmt::format("{:.2f}", median.us));
  row("  CPU of the daemon", fmt::format("{:.2f}", median.server_cpu_us));
  row("  CPU of the client", fmt::format("{:.2f}", median.client_cpu_us));
  row("state hash", hash);
  return table;
}

std::string Json(const LockstepBench& options, const LockstepFigures& median, const std::string& hash) {
  return boost::json::serialize(boost::json::object{
             {"robots", options.daemon.robots},
             {"robot", options.daemon.robot},
             {"clients", options.clients},
             {"language", options.language},
             {"fidelity", options.daemon.fidelity},
             {"rays", options.daemon.rays.value_or(0)},
             {"protocol_only", options.protocol_only},
             {"robot_threads", options.daemon.robot_threads.value_or(0)},
             {"threads", options.daemon.threads},
             {"record", options.daemon.record},
             {"rounds", options.client.rounds},
             {"repeats", options.repeats},
             {"rounds_per_s", Rounded(median.rounds_per_s)},
             {"robot_rounds_per_s", std::round(median.rounds_per_s * options.daemon.robots)},
             {"rtf", Rounded(median.rounds_per_s * kStep_s)},
             {"us_per_robot_round", Rounded(median.us)},
             {"server_cpu_us_per_robot_round", Rounded(median.server_cpu_us)},
             {"client_cpu_us_per_robot_round", Rounded(median.client_cpu_us)},
             {"hash", hash}}) +
         "\n";
}

int Run(const LockstepBench& options) {
  const double robot_rounds = static_cast<double>(options.client.rounds) * options.daemon.robots;
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  std::vector<LockstepFigures> all;
  std::string hash;
  for (int repeat = 1; repeat <= options.repeats; ++repeat) {
    if (terminal) std::cerr << fmt::format("\rrepeat {} of {} ", repeat, options.repeats) << std::flush;
    const BenchDaemon daemon(options.daemon);
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

int Measure(LockstepBench options, bool rays_given, bool threads_given) {
  options.client.batch = options.clients == "batch";
  options.client.python = options.language == "python";
  if (options.protocol_only && (!options.client.batch || rays_given)) {
    std::cerr << "coopdyn bench lockstep: --protocol-only is for --clients batch without --rays\n";
    return kExitWrongUse;
  }
  if (rays_given && options.rays > 0) options.daemon.rays = options.rays;
  if (threads_given) options.daemon.robot_threads = options.robot_threads;
  if (options.protocol_only) options.daemon.fidelity = "planar";
  options.client.robots = options.daemon.robots;
  options.client.readings = options.daemon.rays.has_value();
  options.client.at_rest = options.protocol_only;
  options.client.rounds = options.rounds > 0
                              ? options.rounds
                              : std::clamp(kRobotRounds / options.daemon.robots, kFewestRounds, kMostRounds);
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
  BenchDaemonOptions& daemon = options->daemon;
  CLI::App* sub = bench.add_subcommand("lockstep", "Lockstep rounds per second over sockets");
  sub->footer(
      "Example: coopdyn bench lockstep --robots 1000 --clients batch --rays 11\n"
      "A round: every robot gets its command, the step runs, every reply has come. Daemon and client are\n"
      "processes of their own; their start and a tenth of the rounds before the first measured one do not "
      "count.");
  sub->add_option("--robots", daemon.robots, "How many, one to the square metre")
      ->check(CLI::Range(1, 20000))
      ->capture_default_str();
  sub->add_option("--robot", daemon.robot, "Their type: a folder of robots/")->capture_default_str();
  sub->add_option("--clients", options->clients, "per-robot: a connection each; batch: one team on /swarm")
      ->check(CLI::IsMember({"per-robot", "batch"}))
      ->capture_default_str();
  sub->add_option("--language", options->language, "Of the client: cpp or python")
      ->check(CLI::IsMember({"cpp", "python"}))
      ->capture_default_str();
  sub->add_option(
         "--rays", options->rays,
         "Number of single rays all round whose distances are read each round; 0: none, a team its poses")
      ->check(CLI::Range(0, 360));
  sub->add_option("--range", daemon.range_m, "Range of the rays, m")
      ->check(NumberIn(0.001, 1000))
      ->capture_default_str();
  sub->add_option("--fidelity", daemon.fidelity, "full, rolling or planar")
      ->check(CLI::IsMember({"full", "rolling", "planar"}))
      ->capture_default_str();
  sub->add_flag("--protocol-only", options->protocol_only,
                "A team at rest, planar, that reads its poses: the step costs next to nothing");
  sub->add_option("--robot-threads", options->robot_threads, "Threads for the robots' connections")
      ->check(CLI::Range(1, 10000));
  sub->add_option("--threads", daemon.threads, "Threads of sensing and physics")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  sub->add_option("--record", daemon.record, "Record the run, with so much: poses, or as --record-what");
  sub->add_option("--rounds", options->rounds, "Measured rounds of each repeat (default: 50,000 by robots)")
      ->check(CLI::Range(1, 10'000'000));
  sub->add_option("--repeats", options->repeats, "Runs of which the median is told")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_flag("--json", options->json, "Print one JSON object instead of a table");
  sub->callback([sub, options, &chosen] {
    const bool rays = sub->get_option("--rays")->count() > 0;
    const bool threads = sub->get_option("--robot-threads")->count() > 0;
    chosen = [options, rays, threads] { return Measure(*options, rays, threads); };
  });
}

}  // namespace coopdyn
