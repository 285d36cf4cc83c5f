// SPDX-License-Identifier: MIT
// Physics, sensing and rendering by themselves, per step (Google Benchmark; CPU time).
#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "bench_scene.h"
#include "server/physics/world.h"
#include "server/render/picture_maker.h"
#include "server/sensing/readings.h"

namespace coopdyn {
namespace {

/// A world whose robots drive circles of their own.
class Driven {
 public:
  explicit Driven(int robots) : scene_(MakeScene(BenchScenario(robots), 1)) {
    Diagnostics diagnostics;
    world_ = PhysicsWorld::Build(scene_, 1, diagnostics);
    for (int i = 0; i < robots; ++i) setpoints_.push_back({3.0 + 0.1 * (i % 7), 3.5});
  }

  void Step() { world_->Step(kDefaultStep, 1, setpoints_); }

  std::shared_ptr<Frame> Capture() {
    auto frame = std::make_shared<Frame>();
    frame->scene = scene_;
    frame->step = ++step_;
    world_->Fill(*frame);
    return frame;
  }

 private:
  std::shared_ptr<const Scene> scene_;
  std::unique_ptr<PhysicsWorld> world_;
  std::vector<std::array<double, 2>> setpoints_;
  std::uint64_t step_ = 0;
};

void PerRobot(benchmark::State& state) {
  state.counters["us_per_robot_step"] =
      benchmark::Counter(static_cast<double>(state.iterations() * state.range(0)) * 1e-6,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void BM_Physics(benchmark::State& state) {
  Driven driven(static_cast<int>(state.range(0)));
  for (int k = 0; k < 100; ++k) driven.Step();
  for (auto _ : state) driven.Step();
  PerRobot(state);
}

void BM_PhysicsAndFrame(benchmark::State& state) {
  Driven driven(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    driven.Step();
    benchmark::DoNotOptimize(driven.Capture());
  }
  PerRobot(state);
}

/// All eleven distances and the target of every robot.
void BM_Sensing(benchmark::State& state) {
  const int robots = static_cast<int>(state.range(0));
  Driven driven(robots);
  for (auto _ : state) {
    state.PauseTiming();
    const auto frame = driven.Capture();
    state.ResumeTiming();
    for (int robot = 0; robot < robots; ++robot) {
      benchmark::DoNotOptimize(Distances(*frame, robot));
      benchmark::DoNotOptimize(SeenTargets(*frame, robot));
    }
  }
  PerRobot(state);
}

/// One picture, 640 x 480, as a JPEG of the live view.
void BM_Render(benchmark::State& state) {
  Driven driven(static_cast<int>(state.range(0)));
  PictureMaker maker(RendererKind::kAuto);
  ImageRequest request;
  request.format = ImageFormat::kJpeg;
  for (auto _ : state) {
    driven.Step();
    const auto frame = driven.Capture();
    benchmark::DoNotOptimize(maker.Make(*frame, request));
  }
}

BENCHMARK(BM_Physics)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_PhysicsAndFrame)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Sensing)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Render)->Arg(1)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace coopdyn

BENCHMARK_MAIN();
