// SPDX-License-Identifier: MIT
// The physics world of one scene. Whoever holds the step baton (server/physics/stepper.h) owns it; no locks
// inside.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/base/diagnostics.h"
#include "server/base/worker_pool.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A body that exploded (not finite, or beyond a stated speed) and is held where it was last sane.
struct FrozenBody {
  std::string name;  // of the robot or object
  std::string why;   // e.g. "speed 312 m/s"
};

class PhysicsWorld {
 public:
  /// Builds the bodies of `scene`. Null, with errors at the model's lines, if a dynamic body starts inside
  /// another. `pool` (null: none) outlives it and makes steps faster, never different.
  static std::unique_ptr<PhysicsWorld> Build(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                             Diagnostics& diagnostics, WorkerPool* pool = nullptr);
  ~PhysicsWorld();

  /// Advances by `step` in `substeps` equal parts. `setpoints`: of the scene's channels. Frozen bodies are
  /// held. Deterministic: depends on the state and the arguments alone.
  void Step(Nanoseconds step, int substeps, std::span<const Setpoint> setpoints);

  /// Writes bodies, channels (set-points before the first step: zeros) and solver_seed into `frame`; no
  /// actuator is commanded.
  void Fill(Frame& frame) const;
  /// The world of `scene` from now on, in the exact state of `frame`, which has this scene: the next steps
  /// give the same bits as a fresh Build() with Restore(). What both scenes have is kept, so one thing more
  /// or less among thousands costs a small part of Build(). Floor and gravity are those of before. @pre the
  /// robots have passed Build() in some scene.
  void Rebuild(std::shared_ptr<const Scene> scene, const Frame& frame);
  /// Takes the exact state of `frame` (of the same scene), so that the next steps give the same bits. Whoever
  /// changes poses in it sets the sleep counters of what may be affected to 0: sleepers look at nothing.
  void Restore(const Frame& frame);
  /// The exact state of `start`, frame 0 of this world, with the solver's seed of `seed`: as a fresh Build().
  void Restart(const Frame& start, std::uint64_t seed);
  /// Bodies frozen since the last call.
  std::vector<FrozenBody> TakeFrozen();

  const Scene& scene() const;

 private:
  struct Impl;
  explicit PhysicsWorld(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// The number of substeps of a step when not given: each at most 10 ms.
int DefaultSubsteps(Nanoseconds step);

}  // namespace coopdyn
