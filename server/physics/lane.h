// SPDX-License-Identifier: MIT
// A small ODE world that solves one batch of islands at a time. It lends bodies to things for a substep,
// loads them with the things' exact states, and reads them back. So ODE keeps no state between substeps, its
// memory stays in the cache for swarms of any size, and several lanes can work at once. One thread at a time.
// Only server/physics includes this file.
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
  /// A reusable list of contacts for the lane's user.
  std::vector<FoundContact>& scratch() { return scratch_; }

  /// Makes enough bodies for these things. Call before loading them.
  void Reserve(std::span<const std::uint32_t> members);
  /// Lends `thing` bodies in the state of `actor`. `channels`: the thing's, with its set-points. Both must
  /// outlive the loan.
  /// @pre it has no limbs
  void Load(std::uint32_t thing, const Actor& actor, std::span<const ChannelState> channels);
  /// Makes contact joints between A and B (null: the floor). A thing that is not loaded counts as static.
  /// `measured`: also measures their forces.
  void Join(std::span<const FoundContact> found, const Actor& a, std::uint32_t index_a, const Actor* b,
            std::uint32_t index_b, double dt_s, bool measured);
  /// The measured contacts. After Step().
  std::span<const MeasuredContact> measured() const { return measured_; }
  /// Advances the loaded things. False: ODE's direct solver gave up on some of them, so that what they would
  /// do is wrong. May throw OdeError; then call Reset().
  bool Step(Solver solver, double dt_s);
  /// The exact state of body `body` of a loaded thing; its sleep counter is 0.
  BodyState Read(std::uint32_t thing, std::size_t body) const;
  /// Rate of a wheel of a loaded thing, rad/s, and the effort of its motor in the last step, N m.
  double JointRate(std::uint32_t thing, std::size_t joint) const;
  double JointEffort(std::uint32_t thing, std::size_t joint) const;
  /// Ends all loans.
  void Unload();
  /// Makes a new ODE world after ODE threw, because the old one may be corrupt.
  void Reset();
  /// Adapts to changed things.
  /// @pre nothing is loaded
  void Fit();

 private:
  /// Bodies and joints that can represent one thing.
  struct Loan {
    std::vector<dBodyID> bodies;
    std::vector<dJointID> joints;
    std::vector<dJointID> motors;              // by channel; null: none
    std::unique_ptr<dJointFeedback[]> forces;  // of `motors`
    const Mechanism* loaded = nullptr;         // whose masses the bodies have
    std::span<const ChannelState> channels;    // of the current borrower
  };
  struct Pool {
    const Mechanism* mechanism = nullptr;  // with several bodies; null: single bodies
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
  OdeThreadingPtr threading_;  // this world's own: ODE's shared one would couple worlds
  OdeWorldPtr world_;
  OdeGroupPtr contacts_;
  std::vector<Pool> pools_;
  std::vector<std::size_t> sizes_;  // by pool: number of loans that Build() makes
  std::vector<Loan*> loan_of_;      // by dynamic thing; null: not loaded
  std::vector<std::uint32_t> loaded_;
  std::vector<MeasuredContact> measured_;
  /// By contact of measured_: the force that ODE reports, and its sign for A.
  struct Feedback {
    std::unique_ptr<dJointFeedback> forces;
    double sign = 1;
  };
  std::vector<Feedback> feedback_;
  /// Set when ODE threw in the middle of a step. Then its threading object must not be freed (it asserts that
  /// its jobs are done) and is kept until the process ends.
  bool broken_ = false;
};

}  // namespace coopdyn
