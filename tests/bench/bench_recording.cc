// SPDX-License-Identifier: MIT
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <boost/json.hpp>
#include <cmath>
#include <filesystem>
#include <future>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "protocol/json_text.h"
#include "server/app/commands.h"
#include "server/app/options.h"
#include "server/controllers/controller_host.h"
#include "server/physics/simulation.h"
#include "server/record/player.h"
#include "server/record/recorder.h"
#include "server/replay/verify.h"
#include "tests/bench/bench_arena.h"
#include "tests/bench/bench_commands.h"
#include "tests/bench/bench_daemon.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/measures.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

struct RecordingBench {
  ArenaOptions arena;
  double seconds = 60;  // simulated
  std::string what = "poses";
  std::string file;  // empty: a temporary one
  int seeks = 200, resets = 1000, reset_robots = 20;
  bool json = false;
};

struct RecordingFigures {
  std::uint64_t steps = 0, bytes = 0;
  std::size_t bodies = 0;
  double live_s = 0, live_cpu_s = 0;                              // without recording
  double recorded_s = 0, recorded_cpu_s = 0, recorder_cpu_s = 0;  // with
  double seek_ms = 0, longest_seek_ms = 0;                        // median, largest
  double verify_s = 0;
  double reset_ms = 0, reset_growth_kb = 0;
};

/// Seeks to random moments of the run on a player's own thread; times each until its frame is shown.
std::string MeasureSeeks(const RecordingBench& options, const std::string& file, const SearchPath& path,
                         RecordingFigures& figures) {
  std::string error;
  auto reader = RunReader::Open(file, error);
  Diagnostics diagnostics;
  if (reader == nullptr) return error;
  if (reader->LoadScenario(path, diagnostics) == nullptr) return diagnostics.ToString();
  const RunExtent extent = reader->extent();
  const SteadyClock clock;
  FrameBoard frames;
  CommandBoard commands;
  Doorbell bell;
  EditQueue edits(bell);
  RunControl control;
  PlayOptions play;
  play.paused = true;
  Player player({frames, commands, edits, control, bell}, std::move(reader), clock, NullLogger(), play);
  if (error = player.Start(); !error.empty()) return error;
  std::jthread thread([&player](std::stop_token stop) { player.Run(std::move(stop)); });
  std::mt19937_64 random(1);
  std::uniform_int_distribution<Nanoseconds> moments(extent.begin, extent.end);
  std::vector<double> took_ms;
  for (int i = 0; i < options.seeks; ++i) {
    std::promise<Error> answered;
    const Nanoseconds began = clock.Now();
    edits.Push({edit::Seek{moments(random)},
                [&answered](const EditResult& result) { answered.set_value(result.error); }});
    if (answered.get_future().get() != Error::kOk) error = "a seek was refused";
    took_ms.push_back(ToSeconds(clock.Now() - began) * 1e3);
  }
  thread.request_stop();
  bell.Ring();
  figures.seek_ms = Median(took_ms);
  figures.longest_seek_ms = took_ms.empty() ? 0 : *std::max_element(took_ms.begin(), took_ms.end());
  return error;
}

std::string MeasureVerify(const std::string& file, const SearchPath& path, RecordingFigures& figures) {
  std::string error;
  const auto reader = RunReader::Open(file, error);
  Diagnostics diagnostics;
  if (reader == nullptr) return error;
  if (reader->LoadScenario(path, diagnostics) == nullptr) return diagnostics.ToString();
  const SteadyClock clock;
  WorkerPool pool(1);
  const Logger logger = NullLogger();
  ControllerOptions controllers;
  controllers.program = ProgramBeside("coopdyn");
  const Nanoseconds began = clock.Now();
  const VerifyReport report = Verify(*reader, {clock, logger, pool, controllers, path}, [](double) {});
  figures.verify_s = ToSeconds(clock.Now() - began);
  const bool equal = report.error.empty() && !report.difference;
  return equal ? "" : "the run does not verify: " + ToString(report);
}

std::string MeasureResets(const RecordingBench& options, RobotLibrary& library, RecordingFigures& figures) {
  ArenaOptions arena;
  arena.robots = options.reset_robots;
  arena.fidelity = Fidelity::kFull;
  arena.robot = "coopbot";
  arena.density_m2 = 0.2;
  Diagnostics diagnostics;
  const auto scenario = MakeArena(arena, library, diagnostics);
  if (scenario == nullptr) return diagnostics.ToString();
  const SteadyClock clock;
  const auto simulation = Simulation::Build(MakeScene(scenario), 1, 1, {}, clock, diagnostics);
  if (simulation == nullptr) return diagnostics.ToString();
  std::vector<Setpoint> setpoints;
  for (std::size_t i = 0; i < scenario->robots.size(); ++i) setpoints.insert(setpoints.end(), {{3}, {4}});
  std::vector<double> took_ms;
  double resident_kb = 0;
  for (int i = 0; i < options.resets; ++i) {
    for (int step = 0; step < 10; ++step) simulation->Step(kDefaultStep, {setpoints, {}, {}});
    const Nanoseconds began = clock.Now();
    simulation->Restart(1, static_cast<std::uint64_t>(i) + 2);
    took_ms.push_back(ToSeconds(clock.Now() - began) * 1e3);
    if (i == options.resets / 10) resident_kb = Resident_kb();
  }
  figures.reset_ms = Median(took_ms);
  figures.reset_growth_kb = Resident_kb() - resident_kb;
  return {};
}

std::string MeasureRecording(const RecordingBench& options, const std::string& file, RobotLibrary& library,
                             RecordingFigures& figures) {
  Diagnostics diagnostics;
  const auto scenario = MakeArena(options.arena, library, diagnostics);
  if (scenario == nullptr) return diagnostics.ToString();
  BenchRunOptions run;
  run.seconds = options.seconds;
  const auto live = RunOnce(scenario, run, diagnostics);
  if (!live) return diagnostics.ToString();
  const SteadyClock clock;
  RecorderOptions record;
  record.file = file;
  std::string unknown;
  record.what = ParseRecordWhat(options.what, unknown);
  if (!record.what) return "--what knows no '" + unknown + "'";
  record.overwrite = true;
  record.version = kVersion;
  std::string failure;
  record.on_failure = [&failure](const std::string& text) { failure = text; };
  Recorder recorder(record, clock, NullLogger());
  if (std::string error = recorder.Check(); !error.empty()) return error;
  run.journal = &recorder;
  const auto recorded = RunOnce(scenario, run, diagnostics);
  if (!recorded) return diagnostics.ToString();
  recorder.Close();
  if (!failure.empty()) return failure;
  if (recorded->hash != live->hash) return "the recorded run ended in another state: please report this";
  figures.steps = live->steps;
  figures.bodies = scenario->robots.size();
  figures.live_s = live->wall_s;
  figures.live_cpu_s = live->cpu_s;
  figures.recorded_s = recorded->wall_s;
  figures.recorded_cpu_s = recorded->cpu_s;
  figures.recorder_cpu_s = recorder.status().cpu_s;
  figures.bytes = fs::file_size(file);
  return {};
}

double BytesPerBodyStep(const RecordingFigures& f) {
  return static_cast<double>(f.bytes) / (static_cast<double>(f.steps) * static_cast<double>(f.bodies));
}

std::string Table(const RecordingBench& options, const RecordingFigures& f) {
  const double body_steps = static_cast<double>(f.steps) * static_cast<double>(f.bodies);
  std::string table =
      fmt::format("{} {}, {}, {} s, recorded: {}\n", options.arena.robots, options.arena.robot,
                  ToString(options.arena.fidelity), options.seconds, options.what);
  const auto row = [&table](const char* name, const std::string& value) {
    table += fmt::format("  {:<44}{:>12}\n", name, value);
  };
  row("live run, s (CPU s)", fmt::format("{:.2f} ({:.2f})", f.live_s, f.live_cpu_s));
  row("recorded run, s (CPU s)", fmt::format("{:.2f} ({:.2f})", f.recorded_s, f.recorded_cpu_s));
  row("recording, CPU us per robot-step", fmt::format("{:.3f}", f.recorder_cpu_s * 1e6 / body_steps));
  row("file, MB", fmt::format("{:.1f}", static_cast<double>(f.bytes) * 1e-6));
  row("bytes per robot-step", fmt::format("{:.2f}", BytesPerBodyStep(f)));
  row("seek, ms: median (longest)", fmt::format("{:.2f} ({:.2f})", f.seek_ms, f.longest_seek_ms));
  row("verify, s (times the live run)", fmt::format("{:.2f} ({:.2f})", f.verify_s, f.verify_s / f.live_s));
  row(fmt::format("reset of {} full robots, ms", options.reset_robots).c_str(),
      fmt::format("{:.3f}", f.reset_ms));
  row("memory grown in the resets, kB", fmt::format("{:.0f}", f.reset_growth_kb));
  return table;
}

std::string Json(const RecordingBench& options, const RecordingFigures& f) {
  return JsonText(boost::json::object{{"robots", options.arena.robots},
                                      {"seconds", options.seconds},
                                      {"what", options.what},
                                      {"live_s", f.live_s},
                                      {"live_cpu_s", f.live_cpu_s},
                                      {"recorded_s", f.recorded_s},
                                      {"recorded_cpu_s", f.recorded_cpu_s},
                                      {"recorder_cpu_s", f.recorder_cpu_s},
                                      {"bytes", f.bytes},
                                      {"bytes_per_robot_step", BytesPerBodyStep(f)},
                                      {"seek_ms", f.seek_ms},
                                      {"longest_seek_ms", f.longest_seek_ms},
                                      {"verify_s", f.verify_s},
                                      {"reset_ms", f.reset_ms},
                                      {"reset_growth_kb", f.reset_growth_kb}}) +
         "\n";
}

int Measure(const RecordingBench& options) {
  const SearchPath path = DataPath({});
  RobotLibrary library(path);
  const bool temporary = options.file.empty();
  const std::string file =
      temporary ? (fs::temp_directory_path() / fmt::format("coopdyn-bench-{}.run", ::getpid())).string()
                : options.file;
  RecordingFigures figures;
  const auto tell = [terminal = ::isatty(STDERR_FILENO) == 1](const char* what) {
    if (terminal) std::cerr << "\r\033[K" << what << std::flush;
  };
  tell("running and recording");
  std::string error = MeasureRecording(options, file, library, figures);
  tell("seeking");
  if (error.empty()) error = MeasureSeeks(options, file, path, figures);
  tell("verifying");
  if (error.empty()) error = MeasureVerify(file, path, figures);
  tell("resetting");
  if (error.empty()) error = MeasureResets(options, library, figures);
  tell("");
  std::error_code ignored;
  if (temporary) fs::remove(file, ignored);
  if (!error.empty()) {
    std::cerr << "coopdyn bench recording: " << error << '\n';
    return kExitErrors;
  }
  std::cout << (options.json ? Json(options, figures) : Table(options, figures)) << std::flush;
  return kExitOk;
}

}  // namespace

void AddBenchRecording(CLI::App& bench, std::function<int()>& chosen) {
  const auto options = std::make_shared<RecordingBench>();
  options->arena.robots = 100;
  options->arena.controller = "diffuse";
  CLI::App* sub = bench.add_subcommand("recording", "What recording, seeking, verifying and resetting take");
  sub->footer("Example: coopdyn bench recording --robots 100 --seconds 3600");
  sub->add_option("--robots", options->arena.robots, "How many, one to the square metre")
      ->check(WholeIn(1, 20000))
      ->capture_default_str();
  sub->add_option("--robot", options->arena.robot, "Their type: a folder of robots/")->capture_default_str();
  sub->add_option("--controller", options->arena.controller, "What drives them")->capture_default_str();
  sub->add_option("--seconds", options->seconds, "Simulated time that is recorded")
      ->check(NumberIn(0.01, 1e6))
      ->capture_default_str();
  sub->add_option("--what", options->what, "What is recorded, as --record-what")->capture_default_str();
  sub->add_option("--file", options->file, "Record here and keep it (default: a temporary file)");
  sub->add_option("--seeks", options->seeks, "Random moments to seek")
      ->check(WholeIn(1, 1000000))
      ->capture_default_str();
  sub->add_option("--resets", options->resets, "How many")->check(WholeIn(1, 1000000))->capture_default_str();
  sub->add_flag("--json", options->json, "Print one JSON object instead of a table");
  sub->callback([options, &chosen] { chosen = [options] { return Measure(*options); }; });
}

}  // namespace coopdyn
