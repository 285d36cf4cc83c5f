// SPDX-License-Identifier: MIT
// Sensing alone: everything from a new frame to the readings of all its robots (Google Benchmark; CPU time).
// One robot per square metre, walls around them.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "bench_scene.h"
#include "server/sensing/readings.h"
#include "tests/server/model/sensor_of.h"

namespace coopdyn {
namespace {

/// `model` with `rays` sensors of one ray each, all round, with range `range_m`.
RobotModel WithRays(RobotModel model, int rays, double range_m) {
  std::vector<SectorModel>& sectors = SensorOf<DistanceModel>(model).sectors;
  SectorModel sensor = sectors.front();
  const Vector3 p = sensor.X_RS.p;
  sectors.clear();
  for (int i = 0; i < rays; ++i) {
    sensor.bearing_rad = 2 * std::numbers::pi * (i + 0.5) / rays - std::numbers::pi;
    sensor.X_RS.q = FromRollPitchYaw(0, 0, sensor.bearing_rad);
    sensor.X_RS.p = sensor.X_RS.q * Vector3(std::hypot(p.x(), p.y()), 0, 0) + Vector3(0, 0, p.z());
    sensor.opening_rad = 0;
    sensor.rays = 1;
    sensor.max_range_m = range_m;
    sectors.push_back(sensor);
  }
  return model;
}

/// Frames of a crowd with different poses in each.
class Crowd {
 public:
  Crowd(RobotModel model, int robots, Fidelity fidelity) {
    const auto scenario =
        SwarmScenario(std::make_shared<const RobotModel>(std::move(model)), fidelity, robots);
    side_ = static_cast<int>(std::ceil(std::sqrt(robots)));
    for (int wall = 0; wall < 4; ++wall) {
      WorldObject object;
      const Quaternion turn = FromRollPitchYaw(0, 0, wall * std::numbers::pi / 2);
      object.shape = Box{{0.1, side_ + 0.2, 0.5}};
      object.X_WO = {turn * Vector3(side_ / 2.0 + 0.05, 0, 0) + Vector3(side_ / 2.0, side_ / 2.0, 0.25),
                     turn};
      scenario->objects.push_back(object);
    }
    scene_ = MakeScene(scenario);
    for (std::vector<BodyState>& bodies : moments_) bodies = Scatter();
    all_.resize(static_cast<std::size_t>(robots));
    std::iota(all_.begin(), all_.end(), 0);
  }

  const std::vector<int>& all() const { return all_; }

  /// The next frame; Give() returns its buffers to this crowd.
  std::unique_ptr<Frame> Take() {
    auto frame = std::make_unique<Frame>();
    frame->scene = scene_;
    frame->step = step_;
    frame->bodies.swap(moments_[step_++ % kMoments]);
    return frame;
  }
  void Give(std::unique_ptr<Frame> frame) { frame->bodies.swap(moments_[frame->step % kMoments]); }

 private:
  static constexpr std::size_t kMoments = 8;

  std::vector<BodyState> Scatter() {
    std::vector<BodyState> bodies(scene_->body_ids.size());
    std::uniform_real_distribution<> inside(-0.35, 0.35), tilt(-1e-4, 1e-4),
        any(-std::numbers::pi, std::numbers::pi);
    for (std::size_t i = 0; i < scene_->robots.size(); ++i) {
      const SceneRobot& robot = scene_->robots[i];
      const bool upright = robot.entry.fidelity == Fidelity::kPlanar;
      const double x = static_cast<double>(i % static_cast<std::size_t>(side_)) + 0.5;
      const double y = static_cast<double>(i / static_cast<std::size_t>(side_)) + 0.5;
      const Pose X_WR{
          {x + inside(random_), y + inside(random_), 0},
          FromRollPitchYaw(upright ? 0 : tilt(random_), upright ? 0 : tilt(random_), any(random_))};
      for (int k = 0; k < robot.body_count; ++k) {
        const LinkModel& link = robot.entry.model->links[static_cast<std::size_t>(k)];
        const Pose X_WB = robot.one_body() ? X_WR * robot.X_BR.Inverse() : X_WR * link.X_RL * link.X_LI;
        BodyState& body = bodies[static_cast<std::size_t>(robot.first_body + k)];
        body.p_WB = X_WB.p;
        body.q_WB = {X_WB.q.w(), X_WB.q.x(), X_WB.q.y(), X_WB.q.z()};
      }
    }
    return bodies;
  }

  int side_ = 1;
  std::mt19937 random_{1};
  std::shared_ptr<const Scene> scene_;
  std::vector<BodyState> moments_[kMoments];
  std::vector<int> all_;
  std::uint64_t step_ = 0;
};

void PerRobot(benchmark::State& state, std::size_t robots) {
  state.counters["us_per_robot"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(robots) * 1e-6,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void Measure(benchmark::State& state, Crowd crowd) {
  WorkerPool pool(1);
  for (auto _ : state) {
    std::unique_ptr<Frame> frame = crowd.Take();
    PrepareDistances(*frame, crowd.all(), pool);
    benchmark::DoNotOptimize(Distances(*frame, 0));
    crowd.Give(std::move(frame));
  }
  PerRobot(state, crowd.all().size());
}

/// Rays per minibot, their range in mm, minibots.
void BM_Sense(benchmark::State& state) {
  const RobotModel model = WithRays(*BenchModel("minibot"), static_cast<int>(state.range(0)),
                                    1e-3 * static_cast<double>(state.range(1)));
  Measure(state, Crowd(model, static_cast<int>(state.range(2)), Fidelity::kRolling));
}

/// The same with wheels as separate bodies.
void BM_SenseFull(benchmark::State& state) {
  const RobotModel model = WithRays(*BenchModel("minibot"), static_cast<int>(state.range(0)),
                                    1e-3 * static_cast<double>(state.range(1)));
  Measure(state, Crowd(model, static_cast<int>(state.range(2)), Fidelity::kFull));
}

/// Coopbots unchanged: 11 sectors of 5 rays of 4 m.
void BM_SenseCoopbot(benchmark::State& state) {
  Measure(state, Crowd(*BenchModel("coopbot"), static_cast<int>(state.range(0)), Fidelity::kRolling));
}

/// Only the robots' positions and the grid.
void BM_Field(benchmark::State& state) {
  Crowd crowd(*BenchModel("minibot"), static_cast<int>(state.range(0)), Fidelity::kRolling);
  WorkerPool pool(1);
  for (auto _ : state) {
    std::unique_ptr<Frame> frame = crowd.Take();
    PrepareDistances(*frame, {}, pool);
    crowd.Give(std::move(frame));
  }
  PerRobot(state, crowd.all().size());
}

/// The neighbours of every robot within 1 m.
void BM_Neighbours(benchmark::State& state) {
  Crowd crowd(*BenchModel("minibot"), static_cast<int>(state.range(0)), Fidelity::kRolling);
  for (auto _ : state) {
    std::unique_ptr<Frame> frame = crowd.Take();
    for (const int robot : crowd.all()) benchmark::DoNotOptimize(Neighbours(*frame, robot).data());
    crowd.Give(std::move(frame));
  }
  PerRobot(state, crowd.all().size());
}

void Sizes(benchmark::internal::Benchmark* bench) {
  for (const auto& [rays, range_mm] : {std::pair{8, 100}, {24, 100}, {11, 4000}}) {
    for (const int robots : {10, 100, 1000, 5000}) bench->Args({rays, range_mm, robots});
  }
}

BENCHMARK(BM_Sense)->Apply(Sizes)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_SenseFull)->Apply(Sizes)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_SenseCoopbot)->Arg(10)->Arg(100)->Arg(1000)->Arg(5000)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Field)->Arg(10)->Arg(1000)->Arg(5000)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Neighbours)->Arg(10)->Arg(1000)->Arg(5000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace coopdyn

BENCHMARK_MAIN();
