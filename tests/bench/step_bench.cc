// SPDX-License-Identifier: MIT
// Physics, sensing and rendering separately, per step (Google Benchmark; CPU time).
#include <benchmark/benchmark.h>

#include <array>
#include <random>
#include <vector>

#include "bench_scene.h"
#include "server/physics/world.h"
#include "server/render/picture_maker.h"
#include "server/sensing/readings.h"

namespace coopdyn {
namespace {

/// A world whose robots drive in separate circles.
class Driven {
 public:
  explicit Driven(int robots) : scene_(MakeScene(BenchScenario(robots))) {
    Diagnostics diagnostics;
    world_ = PhysicsWorld::Build(scene_, 1, diagnostics);
    for (int i = 0; i < robots; ++i) setpoints_.insert(setpoints_.end(), {{3.0 + 0.1 * (i % 7)}, {3.5}});
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
  std::vector<Setpoint> setpoints_;
  std::uint64_t step_ = 0;
};

/// A swarm of minibots, 1 m² each, that wander at 5 cm/s and turn occasionally.
class Swarm {
 public:
  Swarm(Fidelity fidelity, int robots) {
    const auto scenario = SwarmScenario(BenchModel("minibot"), fidelity, robots);
    for (RobotEntry& robot : scenario->robots) {
      robot.X_WR.p += Vector3{Uniform(-0.3, 0.3), Uniform(-0.3, 0.3), 0};
      robot.X_WR.q = FromRollPitchYaw(0, 0, Uniform(-3, 3));
    }
    Diagnostics diagnostics;
    scene_ = MakeScene(scenario);
    world_ = PhysicsWorld::Build(scene_, 1, diagnostics);
    setpoints_.resize(2 * static_cast<std::size_t>(robots));
    frame_.scene = scene_;
  }

  void Step() {
    for (std::size_t i = step_++ % kTurnEvery; 2 * i < setpoints_.size(); i += kTurnEvery) {
      const double turn = Uniform(-1, 1);
      setpoints_[2 * i] = {(0.05 - turn * 0.07) / 0.03};
      setpoints_[2 * i + 1] = {(0.05 + turn * 0.07) / 0.03};
    }
    world_->Step(kDefaultStep, 1, setpoints_);
    world_->Fill(frame_);
  }

 private:
  static constexpr std::size_t kTurnEvery = 100;  // steps
  double Uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }

  std::mt19937 random_{1};
  std::shared_ptr<const Scene> scene_;
  std::unique_ptr<PhysicsWorld> world_;
  std::vector<Setpoint> setpoints_;
  Frame frame_;
  std::size_t step_ = 0;
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

/// One step, and the copy of its state into a frame.
void BM_Swarm(benchmark::State& state, Fidelity fidelity) {
  Swarm swarm(fidelity, static_cast<int>(state.range(0)));
  for (int k = 0; k < 100; ++k) swarm.Step();
  for (auto _ : state) swarm.Step();
  PerRobot(state);
}

/// A swarm with surrounding objects, and the same with one object fewer.
struct Changing {
  explicit Changing(int robots) {
    const auto scenario = SwarmScenario(BenchModel("minibot"), Fidelity::kRolling, robots);
    for (int i = 0; i < robots / 10; ++i) {
      WorldObject object;
      object.shape = Box{Vector3(0.1, 0.1, 0.1)};
      object.X_WO.p = {-5 - 0.2 * (i % 100), -5 - 0.2 * (i / 100), 0.05};
      scenario->objects.push_back(object);
    }
    whole.scene = MakeScene(scenario);
    const auto scene = std::make_shared<Scene>(*whole.scene);
    scene->objects.pop_back();
    less.scene = scene;
    Diagnostics diagnostics;
    world = PhysicsWorld::Build(whole.scene, 1, diagnostics);
    world->Fill(whole);
    world->Fill(less);
  }
  Frame whole, less;
  std::unique_ptr<PhysicsWorld> world;
};

void BM_Rebuild(benchmark::State& state) {
  Changing changing(static_cast<int>(state.range(0)));
  bool whole = false;
  for (auto _ : state) {
    const Frame& frame = whole ? changing.whole : changing.less;
    changing.world->Rebuild(frame.scene, frame);
    whole = !whole;
  }
}

void BM_Build(benchmark::State& state) {
  const Changing changing(static_cast<int>(state.range(0)));
  Diagnostics diagnostics;
  for (auto _ : state) benchmark::DoNotOptimize(PhysicsWorld::Build(changing.whole.scene, 1, diagnostics));
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

BENCHMARK(BM_Rebuild)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Build)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Physics)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BM_Swarm, full, Fidelity::kFull)->Arg(10)->Arg(100)->Arg(1000)->Arg(5000);
BENCHMARK_CAPTURE(BM_Swarm, rolling, Fidelity::kRolling)->Arg(10)->Arg(100)->Arg(1000)->Arg(5000);
BENCHMARK_CAPTURE(BM_Swarm, planar, Fidelity::kPlanar)->Arg(10)->Arg(100)->Arg(1000)->Arg(5000);
BENCHMARK(BM_PhysicsAndFrame)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Sensing)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Render)->Arg(1)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace coopdyn

BENCHMARK_MAIN();
