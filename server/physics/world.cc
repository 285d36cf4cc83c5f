// SPDX-License-Identifier: MIT
#include "server/physics/world.h"

#include <utility>

#include "server/physics/engine.h"
#include "server/physics/ode_setup.h"
#include "server/physics/start_check.h"

namespace coopdyn {

struct PhysicsWorld::Impl {
  Impl(std::shared_ptr<const Scene> keep, const Scene& kept, std::uint64_t seed, WorkerPool* pool)
      : scene(std::move(keep)), engine(kept, seed, pool) {}

  std::shared_ptr<const Scene> scene;
  Engine engine;
};

std::unique_ptr<PhysicsWorld> PhysicsWorld::Build(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                                  Diagnostics& diagnostics, WorkerPool* pool) {
  const int errors = diagnostics.errors();
  CheckModels(*scene, diagnostics);
  if (diagnostics.errors() > errors) return nullptr;
  const Scene& kept = *scene;
  auto impl = std::make_unique<Impl>(std::move(scene), kept, seed, pool);
  CheckStart(kept, impl->engine.things(), diagnostics);
  if (diagnostics.errors() > errors) return nullptr;
  return std::unique_ptr<PhysicsWorld>(new PhysicsWorld(std::move(impl)));
}

PhysicsWorld::PhysicsWorld(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PhysicsWorld::~PhysicsWorld() = default;

void PhysicsWorld::Step(Nanoseconds step, int substeps, std::span<const Setpoint> setpoints) {
  EnsureOde();
  impl_->engine.Step(step, substeps, setpoints);
}

void PhysicsWorld::Fill(Frame& frame) const {
  const WorldState& state = impl_->engine.state();
  frame.bodies = state.bodies;
  frame.channels = state.channels;
  frame.commanded.assign(impl_->scene->actuators.size(), 0);
  frame.solver_seed = state.solver_seed;
}

void PhysicsWorld::Rebuild(std::shared_ptr<const Scene> scene, const Frame& frame) {
  EnsureOde();
  impl_->engine.Rebuild(*scene, frame);
  impl_->scene = std::move(scene);  // the engine has let go of the one before
}

void PhysicsWorld::Restore(const Frame& frame) {
  EnsureOde();
  impl_->engine.Restore(frame);
}

void PhysicsWorld::Restart(const Frame& start, std::uint64_t seed) {
  Restore(start);
  impl_->engine.SetSolverSeed(seed);
  impl_->engine.frozen().clear();
}

std::vector<FrozenBody> PhysicsWorld::TakeFrozen() {
  return std::exchange(impl_->engine.frozen(), {});
}

const Scene& PhysicsWorld::scene() const {
  return *impl_->scene;
}

int DefaultSubsteps(Nanoseconds step) {
  return static_cast<int>((step + kMaxSubstep - 1) / kMaxSubstep);
}

}  // namespace coopdyn
