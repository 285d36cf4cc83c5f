// SPDX-License-Identifier: MIT
// Bodies that explode are held where they were last sane, so that the rest of the world goes on.
// Only server/physics includes this file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/physics/ode_world.h"
#include "server/physics/world.h"

namespace coopdyn {

inline constexpr double kMaxSpeed_m_s = 100;
inline constexpr double kMaxTurnRate_rad_s = 1000;

/// Why `state` is not sane, e.g. "speed 312 m/s"; nothing if it is.
std::optional<std::string> WhyInsane(const BodyState& state);

/// All bodies before a substep.
class LastSane {
 public:
  void Remember(const OdeWorld& ode);
  /// Holds every owner with an insane body at the remembered state, at rest. Appends what it froze to
  /// `frozen`.
  void FreezeInsane(OdeWorld& ode, std::vector<FrozenBody>& frozen) const;
  /// After a failure inside ODE: takes all bodies back and freezes the owner that was fastest. False if all
  /// are frozen.
  bool FreezeFastest(OdeWorld& ode, const std::string& why, std::vector<FrozenBody>& frozen) const;

 private:
  std::vector<BodyState> bodies_;
};

/// Holds `owner` where its bodies are: at rest, disabled, its contacts those of a static thing.
void Hold(OdeWorld& ode, Owner& owner);

}  // namespace coopdyn
