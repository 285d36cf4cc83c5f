// SPDX-License-Identifier: MIT
// Measurements for sensors in each step: accelerations, wrenches, batteries, odometry, contact forces
// (docs/physics.md has the formulas). A scene without such sensors costs nothing. Part of the world's state,
// owned by the holder of the baton. Only server/physics includes this file.
#pragma once

#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/things.h"
#include "server/state/frame.h"

namespace coopdyn {

/// A contact in a substep, and the mean force in it.
struct MeasuredContact {
  static constexpr std::uint32_t kFloor = ~std::uint32_t{0};

  std::uint32_t a = 0, b = kFloor;  // things
  const Part* part_a = nullptr;
  const Part* part_b = nullptr;
  Vector3 p_W = Vector3::Zero();
  Vector3 normal_W = Vector3::Zero();  // from B to A
  Vector3 force_W = Vector3::Zero();   // of B on A, N
};

class Measures {
 public:
  /// Sets the sensors to those of `scene` with its `things`; both must outlive their use. Resets all values
  /// to those of the start.
  void Fit(const Scene& scene, const Things& things);
  /// There is nothing to measure.
  bool empty() const { return robots_.empty() && wants_.empty(); }
  /// The forces on this thing are measured.
  bool Wants(std::uint32_t thing) const { return thing < wants_.size() && wants_[thing] != 0; }
  /// The work of this thing's motors is measured.
  bool MeasuresWork(std::uint32_t thing) const {
    return thing < wants_work_.size() && wants_work_[thing] != 0;
  }

  /// Begins a step. `bodies`: as Frame::bodies.
  void Begin(std::span<const BodyState> bodies);
  /// Adds the contacts of some islands in a substep that is `share` of the step.
  void Add(std::span<const MeasuredContact> contacts, double share);
  /// Adds the work that a motor has done or absorbed in a substep. Thread-safe for different channels.
  void AddWork(std::size_t channel, double work_j) { work_j_[channel] += std::abs(work_j); }
  /// Notes that a thing was in flight (LimbSolver::flies()) in a substep that is `share` of the step.
  /// Thread-safe for different things.
  void AddFlight(std::uint32_t thing, double share) {
    if (thing < flight_.size()) flight_[thing] += share;
  }
  /// Identifies a finished step.
  struct Moment {
    double dt_s = 0;
    std::uint64_t seed = 0, step = 0;  // of the resulting frame
  };
  void End(const Moment& moment, std::span<const BodyState> bodies, std::span<const ChannelState> channels);

  void Fill(Frame& frame) const {
    frame.measured = values_;
    frame.contacts = contacts_;
  }
  /// Replaces the values after the step, when channels' filters have advanced theirs.
  void Keep(std::span<const double> values) { values_.assign(values.begin(), values.end()); }
  /// Restores the values of `frame`, or those of the start if it has none.
  void Restore(const Frame& frame);

 private:
  struct Sensor {
    const SensorKind* kind = nullptr;
    std::size_t first = 0;     // of values_
    std::uint32_t number = 0;  // of its kind, from 1
  };
  /// A robot with such sensors.
  struct Measured {
    int robot = 0;
    std::uint32_t thing = 0;
    std::vector<Sensor> sensors;
    std::vector<BodyState> before;  // its bodies when the step began
  };
  /// An added contact.
  struct AddedContact {
    MeasuredContact contact;  // its force is multiplied by `share`
    std::uint32_t index = 0;  // among the contacts of the same two parts
    double share = 0;
  };
  struct ContactOfRobot {
    std::int32_t robot = 0;
    std::uint32_t contact = 0;  // index into contacts_
    auto operator<=>(const ContactOfRobot&) const = default;
  };
  /// A rigid piece of a robot before and after the step.
  struct Motion {
    Vector3 p_W, middle_W;  // its centre of mass before the step, and at mid-step
    Vector3 P_W, P_next_W;  // momentum
    Vector3 L_W, L_next_W;  // angular momentum about the centre of mass
  };

  std::vector<double> StartValues() const;
  ContactEnd EndOf(std::uint32_t thing, const Part* part) const;
  bool Sleeps(const ContactEnd& end, std::span<const BodyState> bodies) const;
  void EndContacts(std::span<const BodyState> bodies);
  void SortContactsByRobot();
  /// A link's frame in its body.
  Pose PlaceInBody(const Measured& of, int link) const;
  Motion MotionOf(const Measured& of, std::span<const BodyState> now, int link, double mass_kg,
                  const Pose& X_LI, const Vector3& inertia_kg_m2) const;

  // Each writes its sensor's values.
  void Measure(const ImuModel& model, const Measured& of, std::span<const BodyState> now,
               const Moment& moment, std::span<double> values) const;
  void Measure(const WrenchModel& model, const Measured& of, std::span<const BodyState> now,
               const Moment& moment, std::span<double> values) const;
  void Measure(const BatteryModel& model, const Measured& of, std::span<const BodyState> now,
               std::span<const ChannelState> channels, const Moment& moment, std::span<double> values) const;
  void Measure(const ChannelModel& model, const Measured& of, std::span<double> values) const;
  void Measure(const OdometryModel& model, const Measured& of, std::uint32_t number,
               std::span<const ChannelState> channels, const Moment& moment, std::span<double> values) const;

  const Scene* scene_ = nullptr;
  const Things* things_ = nullptr;
  std::vector<Measured> robots_;
  std::vector<std::uint8_t> wants_;       // by dynamic thing
  std::vector<std::uint8_t> wants_work_;  // by dynamic thing
  std::vector<double> flight_;            // by dynamic thing: share of this step in flight; empty if unused
  std::vector<double> work_j_;            // by channel: its motor's work in this step, done or absorbed
  std::vector<std::uint32_t> thing_of_object_;  // by object of the scene
  std::vector<double> values_;                  // as Frame::measured
  std::vector<Contact> contacts_;               // as Frame::contacts
  std::vector<AddedContact> gathered_;          // of this step
  std::vector<ContactOfRobot> by_robot_;        // sorted; of contacts_ at the end of the step
};

}  // namespace coopdyn
