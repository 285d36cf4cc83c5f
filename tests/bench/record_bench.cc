// SPDX-License-Identifier: MIT
// CPU time of the recorder's thread per step, and a run's size on disk (Google Benchmark; CPU time of the
// writer, poses only unless stated otherwise).
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "bench_scene.h"
#include "server/physics/world.h"
#include "server/record/run_writer.h"
#include "server/state/pose_codec.h"

namespace coopdyn {
namespace {

constexpr int kFrames = 50;            // different ones, used cyclically
constexpr std::uint64_t kCommit = 20;  // steps: 200 ms in real time
constexpr std::uint64_t kKeyframe = 500;

/// Frames of a swarm of minibots of one body each, 1 m² each, that wander.
class Swarm {
 public:
  explicit Swarm(int robots) {
    Diagnostics diagnostics;
    const auto scene = MakeScene(SwarmScenario(BenchModel("minibot"), Fidelity::kRolling, robots));
    auto world = PhysicsWorld::Build(scene, 1, diagnostics);
    std::vector<Setpoint> setpoints(2 * static_cast<std::size_t>(robots));
    std::mt19937 random(1);
    for (Setpoint& setpoint : setpoints) {
      setpoint = {1 + static_cast<double>(random() % 100) / 100};
    }
    for (int step = 0; step < kFrames; ++step) {
      world->Step(kDefaultStep, 1, setpoints);
      auto frame = std::make_shared<Frame>();
      frame->scene = scene;
      world->Fill(*frame);
      for (std::size_t i = 0; i < setpoints.size(); ++i) frame->channels[i].setpoint = setpoints[i];
      frames_.push_back(std::move(frame));
    }
  }

  /// Step `step` of a run that cycles through the frames.
  const std::shared_ptr<Frame>& At(std::uint64_t step) {
    const std::shared_ptr<Frame>& frame = frames_[step % frames_.size()];
    frame->step = step;
    frame->time = static_cast<Nanoseconds>(step) * kDefaultStep;
    return frame;
  }

 private:
  std::vector<std::shared_ptr<Frame>> frames_;
};

/// All work of the recorder's thread for a step: hash, row, its share of commits and keyframes.
void BM_Record(benchmark::State& state, std::size_t page_size, const RecordWhat& what) {
  Swarm swarm(static_cast<int>(state.range(0)));
  const std::string file =
      (std::filesystem::temp_directory_path() / ("record_bench" + std::to_string(::getpid()) + ".run"));
  SavedState first;
  first.frame = swarm.At(0);
  RunWriterOptions options;
  options.header = HeaderOf(*first.frame, Mode::kLockstep, what, 0);
  options.page_size = page_size;
  options.overwrite = true;
  std::string error;
  const auto writer = RunWriter::Create(file, options, first, error);
  if (writer == nullptr) return state.SkipWithError(error.c_str());
  const std::uint64_t empty = writer->bytes();
  std::uint64_t step = 0;
  for (auto _ : state) {
    ++step;
    SavedState now;
    now.frame = swarm.At(step);
    if (!writer->AddStep(*now.frame)) state.SkipWithError(writer->error().c_str());
    if (step % kKeyframe == 0) writer->AddKeyframe(now);
    if (step % kCommit == 0) writer->Commit();
  }
  std::string remark;
  writer->Close(remark);
  const double bytes = static_cast<double>(writer->bytes() - std::min(empty, writer->bytes()));
  const double body_steps = static_cast<double>(step) * static_cast<double>(first.frame->bodies.size());
  state.counters["bytes_per_body_step"] = bytes / body_steps;
  state.counters["file_bytes"] = static_cast<double>(writer->bytes());
  std::filesystem::remove(file);
}

void BM_EncodePoses(benchmark::State& state) {
  Swarm swarm(static_cast<int>(state.range(0)));
  std::vector<std::byte> blob;
  for (auto _ : state) {
    blob.clear();
    EncodePoses(swarm.At(1)->bodies, blob);
    benchmark::DoNotOptimize(blob.data());
  }
}

void BM_Hash(benchmark::State& state) {
  Swarm swarm(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(StateHash(*swarm.At(1)));
}

const RecordWhat kPoses{};
const RecordWhat kAll{true, true, true, true};

void OfTwoSizes(benchmark::internal::Benchmark* bench) {
  bench->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);
}

BENCHMARK_CAPTURE(BM_Record, poses, std::size_t{0}, kPoses)
    ->Arg(10)
    ->Arg(100)
    ->Arg(1000)
    ->Arg(5000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BM_Record, all, std::size_t{0}, kAll)->Arg(10)->Arg(50)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BM_Record, page4096, std::size_t{4096}, kPoses)->Apply(OfTwoSizes);
BENCHMARK_CAPTURE(BM_Record, page8192, std::size_t{8192}, kPoses)->Apply(OfTwoSizes);
BENCHMARK_CAPTURE(BM_Record, page16384, std::size_t{16384}, kPoses)->Apply(OfTwoSizes);
BENCHMARK_CAPTURE(BM_Record, page32768, std::size_t{32768}, kPoses)->Apply(OfTwoSizes);
BENCHMARK_CAPTURE(BM_Record, page65536, std::size_t{65536}, kPoses)->Apply(OfTwoSizes);
BENCHMARK(BM_EncodePoses)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Hash)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace coopdyn

BENCHMARK_MAIN();
