// SPDX-License-Identifier: MIT
// A scene for tests of whole simulations: robots of every fidelity in a crowd, alone and parked, things of
// every shape, and broadcasts that take their time. One thread.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "server/base/clock.h"
#include "server/physics/simulation.h"
#include "tests/server/model/sensor_of.h"
#include "tests/server/physics/physics_scene.h"
#include "tests/server/state/wheels.h"

namespace coopdyn {

/// `kinds`: the fidelities that its robots have in turn.
inline std::shared_ptr<const Scene> SimulationScene(const std::vector<Fidelity>& kinds, int crowd = 20) {
  auto model = std::make_shared<RobotModel>(*SmallRobot());
  SensorOf<NeighboursModel>(*model) = {.range_m = 3, .message_range_m = 3, .delay_steps = 4};
  auto scenario = std::make_shared<Scenario>();
  const auto add = [&](double x_m, double y_m, double heading_rad) {
    RobotEntry entry;
    const std::size_t index = scenario->robots.size();
    entry.id = RobotId{static_cast<std::uint32_t>(index + 1)};
    entry.name = "robot" + std::to_string(index + 1);
    entry.model = model;
    entry.fidelity = kinds[index % kinds.size()];
    entry.X_WR = {{x_m, y_m, 0}, FromRollPitchYaw(0, 0, heading_rad)};
    scenario->robots.push_back(std::move(entry));
  };
  for (int i = 0; i < crowd; ++i) {
    const double x = 0.22 * (i % 5), y = 0.22 * (i / 5);
    add(x, y, std::atan2(0.41 - y, 0.43 - x));  // facing the middle
  }
  for (int i = 0; i < 3; ++i) add(4 + i, 2, i);
  const auto place = [&](const Shape& shape, double x_m, double y_m, double z_m, double mass_kg) {
    WorldObject object;
    object.name = "THING_" + std::to_string(scenario->objects.size() + 1);
    object.shape = shape;
    object.X_WO = {{x_m, y_m, z_m}, Quaternion::Identity()};
    object.mass_kg = mass_kg;
    scenario->objects.push_back(std::move(object));
  };
  place(Box{Vector3(0.1, 4, 0.5)}, 2.1, 0, 0.25, 0);
  place(Box{Vector3(0.2, 0.3, 0.2)}, 0.3, 2.5, 0.3, 1);
  place(Cylinder{0.1, 0.2}, 0.7, 2.5, 0.2, 1);
  place(Sphere{0.1}, -0.5, 0.1, 0.4, 1);
  return MakeScene(scenario);
}

/// A simulation of such a scene and the inputs that it gets, which depend on its step only.
class SteppedSimulation {
 public:
  explicit SteppedSimulation(std::shared_ptr<const Scene> scene, std::uint64_t seed = 1,
                             StepHelpers helpers = {}) {
    Diagnostics diagnostics;
    simulation_ = Simulation::Build(std::move(scene), seed, 1, helpers, clock_, diagnostics);
    if (simulation_ == nullptr) throw std::runtime_error(diagnostics.ToString());
  }
  Simulation& operator*() { return *simulation_; }
  Simulation* operator->() { return simulation_.get(); }

  const FramePtr& Step(Nanoseconds length = kDefaultStep) {
    const std::uint64_t step = simulation_->frame()->step;
    const std::size_t robots = simulation_->scene().robots.size();
    std::vector<WheelSpeeds> wheels(robots);
    std::vector<SentMessage> sent;
    std::vector<std::uint8_t> commanded(robots);
    for (std::size_t i = 0; i < robots; ++i) {
      const bool parked = i + 1 == robots || (step / 60 + i) % 4 == 0;
      if (!parked) {
        wheels[i] = {static_cast<double>((step / 10 + i) % 4 + 1),
                     static_cast<double>((step / 10 + 3 * i) % 5)};
      }
      commanded[i] = (step + i) % 7 == 0;
      if ((step + i) % 5 != 0) continue;
      sent.push_back({static_cast<std::uint32_t>(i), step + 1, {1, {static_cast<double>(step)}}});
    }
    std::vector<Setpoint> setpoints = ByChannel(wheels);
    return simulation_->Step(length, {setpoints, sent, commanded});
  }
  void Steps(int count) {
    for (int i = 0; i < count; ++i) Step();
  }

 private:
  SteadyClock clock_;
  std::unique_ptr<Simulation> simulation_;
};

/// All of a frame that anybody can see, but for the epoch, as a number.
std::uint64_t WholeHash(const Frame& frame);
/// Of the next `count` steps.
std::vector<std::uint64_t> WholeHashes(SteppedSimulation& simulation, int count);

}  // namespace coopdyn
