// SPDX-License-Identifier: MIT
// A small world of ODE that solves one batch of islands at a time: bodies are lent to things for a substep,
// loaded with their exact state, and read back. So ODE remembers nothing from one substep to the next, its
// memory stays in the cache however large the swarm, and several lanes may work at once. One thread at a
// time. Only server/physics includes this file.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/physics/contacts.h"
#include "server/physics/measures.h"
#include "server/physics/ode.h"
#include "server/physics/surface.h"
#include "server/physics/things.h"

namespace coopdyn {

class Lane {
 public:
  enum class Solver { kDirect, kIterative };

  /// @pre `things` outlives it.
  Lane(const Things& things, const WorldSettings& settings);
  ~Lane();
  Lane(const Lane&) = delete;
  Lane& operator=(const Lane&) = delete;

  Collider& collider() { return collider_; }
  /// Room for contacts, for whoever uses the lane.
  std::vector<FoundContact>& scratch() { return scratch_; }

  /// Makes room for these things together. Before they are loaded.
  void Reserve(std::span<const std::uint32_t> members);
  /// Lends `thing` bodies in the state of `actor`; `channels`: of it, with what its motors are to do. They
  /// outlive the loan. @pre it has no limbs
  void Load(std::uint32_t thing, const Actor& actor, std::span<const ChannelState> channels);
  /// Makes contact joints between A and B (null: the floor). A thing that is not loaded counts as static.
  /// `measured`: their forces are wanted.
  void Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a, const Actor* b,
            std::uint32_t index_b, double dt_s, bool measured);
  /// The contacts that were to be measured, after Step().
  std::span<const MeasuredContact> measured() const { return measured_; }
  /// Advances what is loaded. Throws OdeError; then the lane must be Reset().
  void Step(Solver solver, double dt_s);
  /// The exact state of body `body` of a loaded thing; its sleep counter is 0.
  BodyState Read(std::uint32_t thing, std::size_t body) const;
  /// Rate of a wheel of a loaded thing, rad/s, and the effort of its motor in the last step, N m.
  double JointRate(std::uint32_t thing, std::size_t joint) const;
  double JointEffort(std::uint32_t thing, std::size_t joint) const;
  /// Takes all bodies back.
  void Unload();
  /// A new world after ODE threw: its memory is not to be trusted.
  void Reset();
  /// The things have changed. @pre nothing is loaded
  void Fit();

 private:
  /// Bodies and joints that can stand for one thing.
  struct Loan {
    std::vector<dBodyID> bodies;
    std::vector<dJointID> joints;
    std::vector<dJointID> motors;              // by channel; null: none
    std::unique_ptr<dJointFeedback[]> forces;  // of `motors`
    const Mechanism* loaded = nullptr;         // whose masses they have
    std::span<const ChannelState> channels;    // of the thing that it is lent to
  };
  struct Pool {
    const Mechanism* mechanism = nullptr;  // of several bodies; null: single ones
    std::vector<Loan> loans;
    std::size_t used = 0;
  };
  void Build();
  Loan MakeLoan(const Mechanism* mechanism);
  dBodyID BodyOf(std::uint32_t thing, const Part& part) const;

  const Things& things_;
  const WorldSettings settings_;
  Collider collider_;
  std::vector<FoundContact> scratch_;
  OdeThreadingPtr threading_;  // of this world alone: ODE's shared one would tie worlds together
  OdeWorldPtr world_;
  OdeGroupPtr contacts_;
  std::vector<Pool> pools_;
  std::vector<std::size_t> sizes_;  // of pools, to be built; as many as Things::pools
  std::vector<Loan*> loan_of_;      // by dynamic thing; null: not loaded
  std::vector<std::uint32_t> loaded_;
  std::vector<MeasuredContact> measured_;
  /// Of measured_: what ODE says, and the sign with which it acts on A.
  struct Feedback {
    std::unique_ptr<dJointFeedback> forces;
    double sign = 1;
  };
  std::vector<Feedback> feedback_;
  /// Set when ODE threw in the middle of a step: then its threading object may not be freed (it asserts that
  /// its jobs are done) and is kept until the process ends.
  bool broken_ = false;
};

}  // namespace coopdyn
