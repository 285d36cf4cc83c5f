// SPDX-License-Identifier: MIT
#include "server/physics/world.h"

#include <utility>

#include "server/physics/broad_phase.h"
#include "server/physics/contacts.h"
#include "server/physics/freeze.h"
#include "server/physics/islands.h"
#include "server/physics/ode_setup.h"
#include "server/physics/ode_world.h"
#include "server/physics/start_check.h"

namespace coopdyn {

namespace {

// A contact that sinks in is pushed out by this share of its depth in a substep, but never faster than
// kMaxPushOut: 0.4 keeps wheels at their radius and hinges together at every step size; the cap is what makes
// impacts not bounce.
constexpr double kErp = 0.4;
constexpr double kMaxPushOut_m_s = 0.1;
// Softness (m/s per N·s): shares a load among redundant contacts; small enough that nothing creeps on a
// slope.
constexpr double kCfm = 1e-6;

}  // namespace

struct PhysicsWorld::Impl {
  std::shared_ptr<const Scene> scene;
  std::unique_ptr<OdeWorld> ode;
  std::unique_ptr<BroadPhase> broad_phase;
  Islands islands;
  LastSane last_sane;
  std::uint64_t solver_seed = 0;
  std::vector<RobotState> robots;
  std::vector<FrozenBody> frozen;

  void BuildWorld() {
    ode = BuildOdeWorld(*scene);
    dWorldID world = ode->world.get();
    dWorldSetERP(world, kErp);
    dWorldSetCFM(world, kCfm);
    dWorldSetContactMaxCorrectingVel(world, kMaxPushOut_m_s);
    dWorldSetQuickStepNumIterations(world, kQuickIterations);
    dWorldSetQuickStepW(world, 1.0);
    broad_phase = std::make_unique<BroadPhase>(*ode);
  }

  void SetMotors(std::span<const std::array<double, 2>> setpoints) {
    for (std::size_t i = 0; i < robots.size(); ++i) {
      robots[i].setpoint_rad_s = i < setpoints.size() ? setpoints[i] : std::array<double, 2>{};
      for (std::size_t side = 0; side < 2; ++side) {
        dJointID hinge = ode->motors[i][side];
        if (hinge != nullptr) dJointSetHingeParam(hinge, dParamVel, robots[i].setpoint_rad_s[side]);
      }
    }
  }

  void FindContacts() {
    OdeWorld& world = *ode;
    const std::size_t moving = static_cast<std::size_t>(world.first_static);
    islands.Reset(world);
    for (std::size_t i = 0; i < moving; ++i) {
      if (world.owners[i].frozen) continue;
      islands.AddRows(i, AddFloorContacts(world, world.owners[i], scene->floor.friction));
    }
    for (const auto& [a, b] : broad_phase->FindPairs(world)) {
      const bool fixed_a = world.owners[a].frozen;
      const bool fixed_b = b >= moving || world.owners[b].frozen;
      if (fixed_a && fixed_b) continue;
      const int rows = AddContacts(world, world.owners[a], world.owners[b]);
      if (rows == 0) continue;
      islands.AddRows(fixed_a ? b : a, rows);
      if (!fixed_a && !fixed_b) islands.Join(a, b);
    }
  }

  void Substep(double dt_s) {
    dRandSetSeed(static_cast<unsigned long>(solver_seed));
    FindContacts();
    Solve(*ode, islands, dt_s);
    dJointGroupEmpty(ode->contacts.get());
    solver_seed = dRandGetSeed();
  }

  /// A substep that survives a failure inside ODE: on a fresh world, without the body that was fastest.
  void SafeSubstep(double dt_s) {
    last_sane.Remember(*ode);
    const std::uint64_t seed = solver_seed;
    for (bool done = false; !done;) {
      try {
        Substep(dt_s);
        done = true;
      } catch (const OdeError& error) {
        solver_seed = seed;
        ode->broken = true;
        Rebuild();
        done = !last_sane.FreezeFastest(*ode, error.what(), frozen);
      }
    }
    last_sane.FreezeInsane(*ode, frozen);
  }

  /// The same owners in a new ODE world; ODE's own memory is not to be trusted after it threw.
  void Rebuild() {
    const std::vector<Owner> owners = ode->owners;
    BuildWorld();
    for (std::size_t i = 0; i < owners.size(); ++i) {
      if (owners[i].frozen) Hold(*ode, ode->owners[i]);
    }
    std::vector<std::array<double, 2>> setpoints;
    for (const RobotState& robot : robots) setpoints.push_back(robot.setpoint_rad_s);
    SetMotors(setpoints);
  }

  void TurnWheels(double dt_s, double share) {
    for (std::size_t i = 0; i < robots.size(); ++i) {
      for (std::size_t side = 0; side < 2; ++side) {
        dJointID hinge = ode->motors[i][side];
        const double rate = hinge == nullptr ? 0 : dJointGetHingeAngleRate(hinge);
        robots[i].wheel_angle_rad[side] += rate * dt_s;
        robots[i].wheel_speed_rad_s[side] += rate * share;
      }
    }
  }
};

std::unique_ptr<PhysicsWorld> PhysicsWorld::Build(std::shared_ptr<const Scene> scene, std::uint64_t seed,
                                                  Diagnostics& diagnostics, WorkerPool* /*pool*/) {
  const int errors = diagnostics.errors();
  CheckModels(*scene, diagnostics);
  if (diagnostics.errors() > errors) return nullptr;
  auto impl = std::make_unique<Impl>();
  impl->scene = std::move(scene);
  impl->solver_seed = seed & 0xffffffff;  // ODE's generator has 32 bits
  impl->robots.resize(impl->scene->robots.size());
  impl->BuildWorld();
  CheckStart(*impl->ode, diagnostics);
  if (diagnostics.errors() > errors) return nullptr;
  return std::unique_ptr<PhysicsWorld>(new PhysicsWorld(std::move(impl)));
}

PhysicsWorld::PhysicsWorld(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PhysicsWorld::~PhysicsWorld() = default;

void PhysicsWorld::Step(Nanoseconds step, int substeps, std::span<const std::array<double, 2>> setpoints) {
  EnsureOde();
  impl_->SetMotors(setpoints);
  for (RobotState& robot : impl_->robots) robot.wheel_speed_rad_s = {};
  const double dt_s = ToSeconds(step) / substeps;
  for (int i = 0; i < substeps; ++i) {
    impl_->SafeSubstep(dt_s);
    impl_->TurnWheels(dt_s, 1.0 / substeps);
  }
}

void PhysicsWorld::Fill(Frame& frame) const {
  const OdeWorld& ode = *impl_->ode;
  frame.bodies.resize(ode.bodies.size());
  for (std::size_t i = 0; i < ode.bodies.size(); ++i) frame.bodies[i] = ReadBody(ode.bodies[i]);
  frame.robots = impl_->robots;
  for (const Owner& owner : ode.owners) {
    if (!owner.frozen) continue;
    if (owner.robot >= 0) frame.robots[static_cast<std::size_t>(owner.robot)].frozen = true;
    for (int i = 0; i < owner.body_count; ++i) {
      frame.bodies[static_cast<std::size_t>(owner.first_body) + static_cast<std::size_t>(i)].sleep_counter =
          BodyState::kFrozen;
    }
  }
  frame.solver_seed = impl_->solver_seed;
}

void PhysicsWorld::Restore(const Frame& frame) {
  EnsureOde();
  OdeWorld& ode = *impl_->ode;
  for (std::size_t i = 0; i < ode.bodies.size(); ++i) WriteBody(ode.bodies[i], frame.bodies[i]);
  for (Owner& owner : ode.owners) {
    if (owner.body_count == 0) continue;
    if (frame.bodies[static_cast<std::size_t>(owner.first_body)].frozen()) {
      Hold(ode, owner);
      continue;
    }
    owner.frozen = false;
    for (int i = 0; i < owner.body_count; ++i) {
      dBodyEnable(ode.bodies[static_cast<std::size_t>(owner.first_body) + static_cast<std::size_t>(i)]);
    }
  }
  impl_->robots = frame.robots;
  for (RobotState& robot : impl_->robots) robot.frozen = false;  // Fill() derives it from the bodies
  impl_->solver_seed = frame.solver_seed;
}

std::vector<FrozenBody> PhysicsWorld::TakeFrozen() {
  return std::exchange(impl_->frozen, {});
}

const Scene& PhysicsWorld::scene() const {
  return *impl_->scene;
}

int DefaultSubsteps(Nanoseconds step) {
  return static_cast<int>((step + kMaxSubstep - 1) / kMaxSubstep);
}

}  // namespace coopdyn
