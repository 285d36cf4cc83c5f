// SPDX-License-Identifier: MIT
#include "server/physics/ode_world.h"

#include <algorithm>
#include <cstring>

#include "server/base/mutex.h"

namespace coopdyn {

namespace {

// Reachable, so that it does not count as leaked.
void KeepForever(dThreadingImplementationID threading) {
  static Mutex mutex;
  static std::vector<dThreadingImplementationID>* const kept = new std::vector<dThreadingImplementationID>;
  const MutexLock lock(mutex);
  kept->push_back(threading);
}

}  // namespace

OdeWorld::~OdeWorld() {
  if (broken) KeepForever(threading.release());
}

std::span<const Part> OdeWorld::PartsOf(const Owner& owner) const {
  if (owner.one_body != nullptr) return owner.one_body->parts;
  return std::span(parts).subspan(static_cast<std::size_t>(owner.first_part),
                                  static_cast<std::size_t>(owner.part_count));
}

PlacedRotation OdeWorld::PlaceOf(const Owner& owner, std::size_t part) const {
  if (owner.one_body != nullptr) {
    const std::size_t first = static_cast<std::size_t>(first_places[static_cast<std::size_t>(owner.slot)]);
    const Place& place = places[first + part];
    return {place.p, place.R};
  }
  dGeomID geom = parts[static_cast<std::size_t>(owner.first_part) + part].geom;
  return {dGeomGetPosition(geom), dGeomGetRotation(geom)};
}

dBodyID OdeWorld::BodyOf(const Owner& owner, const Part& part) const {
  if (owner.one_body != nullptr) return slots[static_cast<std::size_t>(owner.slot)].body;
  return part.body < 0 ? nullptr : bodies[static_cast<std::size_t>(part.body)];
}

void OdeWorld::TakeSlot(Owner& owner, const BodyState& state) {
  const std::size_t slot = static_cast<std::size_t>(slots_in_use++);
  owner.slot = static_cast<int>(slot);
  if (slot == slots.size()) {
    slots.push_back({dBodyCreate(world.get())});
    dBodySetAutoDisableFlag(slots.back().body, 0);
    dBodyDisable(slots.back().body);
    first_places.push_back(0);
  }
  first_places[slot] = static_cast<int>(places.size());
  const auto& R = state.R_WB;
  for (const Part& part : owner.one_body->parts) {
    Place& place = places.emplace_back();
    for (std::size_t row = 0; row < 3; ++row) {
      const double* r = R.data() + 3 * row;
      place.p[row] = state.p_WB[static_cast<Eigen::Index>(row)] + r[0] * part.p_BG.x() +
                     r[1] * part.p_BG.y() + r[2] * part.p_BG.z();
      for (int column = 0; column < 3; ++column) {
        place.R[4 * row + static_cast<std::size_t>(column)] =
            r[0] * part.R_BG(0, column) + r[1] * part.R_BG(1, column) + r[2] * part.R_BG(2, column);
      }
      place.R[4 * row + 3] = 0;
    }
  }
}

void OdeWorld::LoadSlot(const Owner& owner, const BodyState& state) {
  Slot& slot = slots[static_cast<std::size_t>(owner.slot)];
  const OneBody& robot = *owner.one_body;
  if (slot.loaded != &robot) {
    slot.loaded = &robot;
    Matrix3 I = robot.inertia_kg_m2;
    if (robot.planar) {
      // Nothing tilts it; its own friction with the floor stands for its weight.
      constexpr double kUntiltable_kg_m2 = 1e6;
      I.setZero();
      I.diagonal() = Vector3(kUntiltable_kg_m2, kUntiltable_kg_m2, robot.inertia_kg_m2(2, 2));
    }
    dMass mass;
    dMassSetParameters(&mass, robot.mass_kg, 0, 0, 0, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
    dBodySetMass(slot.body, &mass);
    dBodySetGravityMode(slot.body, robot.planar ? 0 : 1);
  }
  WriteBody(slot.body, state);
  dBodyEnable(slot.body);
}

void OdeWorld::FreeSlots() {
  for (int i = 0; i < slots_in_use; ++i) dBodyDisable(slots[static_cast<std::size_t>(i)].body);
  slots_in_use = 0;
  places.clear();
}

BodyState ReadBody(dBodyID body) {
  BodyState state;
  const dReal* p = dBodyGetPosition(body);
  const dReal* q = dBodyGetQuaternion(body);
  const dReal* R = dBodyGetRotation(body);
  const dReal* v = dBodyGetLinearVel(body);
  const dReal* w = dBodyGetAngularVel(body);
  state.p_WB = {p[0], p[1], p[2]};
  std::copy_n(q, 4, state.q_WB.begin());
  for (std::size_t row = 0; row < 3; ++row) std::copy_n(R + 4 * row, 3, state.R_WB.begin() + 3 * row);
  state.v_WB = {v[0], v[1], v[2]};
  state.w_WB = {w[0], w[1], w[2]};
  return state;
}

void WriteBody(dBodyID body, const BodyState& state) {
  dMatrix3 R{};
  for (std::size_t row = 0; row < 3; ++row) std::copy_n(state.R_WB.begin() + 3 * row, 3, R + 4 * row);
  dBodySetPosition(body, state.p_WB.x(), state.p_WB.y(), state.p_WB.z());
  dBodySetRotation(body, R);  // tells the shapes; but it rounds, hence the raw copies
  std::memcpy(const_cast<dReal*>(dBodyGetRotation(body)), R, sizeof(R));
  std::memcpy(const_cast<dReal*>(dBodyGetQuaternion(body)), state.q_WB.data(), sizeof(state.q_WB));
  dBodySetLinearVel(body, state.v_WB.x(), state.v_WB.y(), state.v_WB.z());
  dBodySetAngularVel(body, state.w_WB.x(), state.w_WB.y(), state.w_WB.z());
}

}  // namespace coopdyn
