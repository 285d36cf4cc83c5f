// SPDX-License-Identifier: MIT
// One substep: who moves by the closed form, who is handed to ODE, who sleeps. Owns the state of the world;
// ODE is told of it and asked. Whoever holds the world uses it; no locks. Only server/physics includes this
// file.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/base/worker_pool.h"
#include "server/physics/broad_phase.h"
#include "server/physics/contacts.h"
#include "server/physics/drive_motion.h"
#include "server/physics/islands.h"
#include "server/physics/ode_world.h"
#include "server/physics/world.h"

namespace coopdyn {

/// All that the next step depends on, besides the scene and the set-points.
struct WorldState {
  std::vector<BodyState> bodies;   // as Frame::bodies
  std::vector<RobotState> robots;  // as Frame::robots
  std::uint64_t solver_seed = 0;
};

class Engine {
 public:
  /// @pre `scene` and `pool` (null: none) outlive it; CheckModels() found no error.
  Engine(const Scene& scene, std::uint64_t solver_seed, WorkerPool* pool);

  const WorldState& state() const { return state_; }
  OdeWorld& ode() { return *ode_; }

  void Step(Nanoseconds step, int substeps, std::span<const std::array<double, 2>> setpoints);
  void Restore(const Frame& frame);
  std::vector<FrozenBody>& frozen() { return frozen_; }

 private:
  void BuildWorld();
  /// Writes the state of what has a body of its own in ODE.
  void TellOde();
  void SetMotors();
  /// A substep that survives a failure inside ODE: on a fresh world, without the body that was fastest.
  void SafeSubstep(Nanoseconds dt);
  void Substep(Nanoseconds dt);

  /// Where every robot wants to go, and the space it needs for that.
  void PlanAll(double dt_s);
  void PlanRobot(std::size_t robot, double dt_s);
  /// Decides who is handed to ODE; true if anybody is.
  bool Sort();
  /// Finds all contacts of this substep, and wakes who sleeps and is touched.
  void Touch(double dt_s);
  /// Contacts of the pairs of Sort(); true if none of them touches a sleeper.
  bool FindAllContacts(double dt_s);
  void Wake(std::size_t owner, double dt_s);
  void AddJoints(double dt_s);
  void RunOde(double dt_s);
  void ReadOwner(std::size_t owner, double dt_s);
  void ReadWheels(const Owner& owner, double dt_s);
  void AdvanceClosed(double dt_s);
  /// Counts how long everybody has been at rest, and lets whole islands sleep.
  void CountRest(Nanoseconds dt);
  bool AtRest(std::size_t owner) const;
  void Sleep(std::size_t owner);
  void Freeze(std::size_t owner, std::string why);

  /// Calls work(first, end) for parts of [0, count), on all threads if that pays.
  template <typename Work>
  void ForAll(std::size_t count, const Work& work);

  const BodyState& first_body(std::size_t owner) const {
    return state_.bodies[static_cast<std::size_t>(first_bodies_[owner])];
  }
  std::span<BodyState> BodiesOf(const Owner& owner) {
    return std::span(state_.bodies)
        .subspan(static_cast<std::size_t>(owner.first_body), static_cast<std::size_t>(owner.body_count));
  }
  std::size_t first_robot() const { return static_cast<std::size_t>(ode_->first_robot); }
  std::size_t dynamic_count() const { return static_cast<std::size_t>(ode_->first_static); }

  const Scene& scene_;
  WorkerPool* const pool_;
  std::unique_ptr<OdeWorld> ode_;
  std::unique_ptr<BroadPhase> broad_phase_;
  Islands islands_;
  WorldState state_;
  std::vector<FrozenBody> frozen_;

  // Of the present step, by robot.
  std::vector<std::array<double, 2>> setpoints_;
  double share_ = 1;  // of a substep in the step
  // Of the present substep.
  std::vector<int> first_bodies_;      // by dynamic owner; never changes
  std::vector<std::uint8_t> moves_;    // by dynamic owner: neither frozen nor asleep
  std::vector<std::uint8_t> near_;     // by dynamic owner: in a pair
  std::vector<std::uint8_t> in_ode_;   // by dynamic owner
  std::vector<double> travel_m_;       // by dynamic owner: how far it may come in this substep
  std::vector<DrivePlan> plans_;       // by robot
  std::vector<std::uint32_t> active_;  // owners handed to ODE
  std::span<const BroadPhase::Pair> pairs_;
  std::vector<FoundContact> found_;
  std::vector<FoundContact> floor_found_;
  std::vector<std::size_t> found_ends_;  // by pair: where its contacts end in found_
  std::vector<std::uint8_t> rested_;     // by owner: of an island's root: all its members
};

}  // namespace coopdyn
