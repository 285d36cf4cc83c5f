// SPDX-License-Identifier: MIT
#include "tests/bench/bench_run.h"

#include <numeric>
#include <stop_token>

#include "server/base/random.h"
#include "server/controllers/controller_host.h"
#include "server/model/drive.h"
#include "server/physics/stepper.h"
#include "server/sensing/channel_filters.h"
#include "server/sensing/readings.h"
#include "tests/bench/bench_daemon.h"
#include "tests/bench/measures.h"

namespace coopdyn {

namespace {

/// Gives every robot without a controller constant wheel speeds of 0 to 0.1 m/s.
void DriveAtRandom(const Scene& scene, std::uint64_t seed, CommandBoard& commands) {
  constexpr double kFastest_m_s = 0.1;
  const Client client{.id = 1, .name = "bench", .peer = {}, .input_ended = false};
  const std::vector<SlotId> slots = commands.FindSlots(scene);
  RandomNumbers random(seed);
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const SceneActuator& actuator = scene.actuators[i];
    const RobotEntry& entry = scene.robots[static_cast<std::size_t>(actuator.robot)].entry;
    const ActuatorModel* const drive = entry.model->drive_actuator();
    if (drive == nullptr || drive->module != actuator.module) continue;
    const double left = random.Next(), right = random.Next();
    if (!entry.controller.empty()) continue;
    const double fastest = kFastest_m_s / entry.model->drive()->wheel_radius_m;
    commands.Command(slots[i], client, SetpointsFor({left * fastest, right * fastest}), std::nullopt,
                     nullptr);
  }
}

}  // namespace

std::optional<BenchRun> RunOnce(const std::shared_ptr<const Scenario>& scenario,
                                const BenchRunOptions& options, Diagnostics& diagnostics) {
  const SteadyClock clock;
  FrameBoard frames;
  CommandBoard commands;
  Doorbell bell;
  EditQueue edits(bell);
  RunControl control;
  WorkerPool pool(options.threads);
  RunOptions run;
  run.mode = Mode::kFree;
  run.duration_s = options.seconds;
  run.ends_daemon = true;
  ControllerOptions controller_options;
  controller_options.in_process = options.controllers_in_process;
  controller_options.threads = options.threads;
  controller_options.program = options.program.empty() ? ProgramBeside("coopdyn") : options.program;
  ControllerHost controllers(controller_options, clock, NullLogger(), pool);
  Stepper stepper({frames, commands, edits, control, bell}, clock, NullLogger(), run,
                  {&pool, &controllers, AdvanceFilters});
  if (!stepper.Start(scenario, diagnostics)) return std::nullopt;
  DriveAtRandom(*frames.Latest()->scene, scenario->simulation.seed, commands);

  if (options.journal != nullptr) edits.Push({edit::SetJournal{options.journal}, nullptr});

  BenchRun result;
  Nanoseconds sensing = 0;
  std::vector<int> robots(scenario->robots.size());
  std::iota(robots.begin(), robots.end(), 0);
  if (options.sense) {
    commands.AddObserver([&](const FramePtr& frame) {
      const Nanoseconds began = clock.Now();
      PrepareDistances(*frame, robots, pool);
      sensing += clock.Now() - began;
    });
  }
  std::stop_source stop;
  double cpu_end_s = 0;
  Nanoseconds wall_end = 0;
  stepper.set_on_ended([&] {
    cpu_end_s = OwnCpu_s() + controllers.child_cpu_s();
    wall_end = clock.Now();
    stop.request_stop();
  });
  const PhaseTimes phases_before = stepper.phase_times();
  const double cpu_start_s = OwnCpu_s() + controllers.child_cpu_s();
  const Nanoseconds wall_start = clock.Now();
  stepper.Run(stop.get_token());

  const FramePtr last = frames.Latest();
  const PhaseTimes phases = stepper.phase_times();
  result.steps = last->step;
  result.simulated_s = last->time_s();
  result.cpu_s = cpu_end_s - cpu_start_s;
  result.wall_s = ToSeconds(wall_end - wall_start);
  result.phases = {.sense = phases.sense - phases_before.sense + sensing,
                   .control = phases.control - phases_before.control,
                   .physics = phases.physics - phases_before.physics,
                   .publish = phases.publish - phases_before.publish};
  result.hash = StateHash(*last);
  result.resident_kb = Resident_kb();
  result.frozen = control.status().frozen;
  for (const Event& event : control.events()) {
    if (event.level == "error") result.problems.push_back(event.text);
  }
  return result;
}

}  // namespace coopdyn
