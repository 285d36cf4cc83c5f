// SPDX-License-Identifier: MIT
// Implements the functions of controller.h by a C++ class. The class has
//
//   struct State { ... };                       plain values: everything that Step() changes
//   State state;
//   static const coopdyn_description* Describe();   its state_size is sizeof(State)
//   MyClass(const coopdyn_robot& robot, const double* options);   may throw: the robot then stands still,
//                                                                   and the exception's text is reported
//   void Reset(std::uint64_t seed);
//   void Step(const coopdyn_readings& readings, coopdyn_command& command);
//
// and the file ends with
//
//   extern "C" const coopdyn_controller* coopdyn_controller_entry() { return coopdyn::Entry<MyClass>(); }
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <type_traits>

#include "controller.h"

namespace coopdyn {

template <typename Controller>
const coopdyn_controller* Entry() {
  static_assert(std::is_trivially_copyable_v<decltype(Controller::state)>, "save() copies its bytes");
  static const coopdyn_controller functions = {
      COOPDYN_CONTROLLER_VERSION,
      [] { return Controller::Describe(); },
      [](const coopdyn_robot* robot, const double* options, char* why, std::size_t size) -> void* {
        try {
          return new Controller(*robot, options);
        } catch (const std::exception& error) {
          std::snprintf(why, size, "%s", error.what());
          return nullptr;
        }
      },
      [](void* instance, std::uint64_t seed) { static_cast<Controller*>(instance)->Reset(seed); },
      [](void* instance, const coopdyn_readings* readings, coopdyn_command* command) {
        static_cast<Controller*>(instance)->Step(*readings, *command);
      },
      [](const void* instance, void* state) {
        const Controller& controller = *static_cast<const Controller*>(instance);
        std::memcpy(state, &controller.state, sizeof(controller.state));
      },
      [](void* instance, const void* state) {
        Controller& controller = *static_cast<Controller*>(instance);
        std::memcpy(&controller.state, state, sizeof(controller.state));
      },
      [](void* instance) { delete static_cast<Controller*>(instance); }};
  return &functions;
}

/// A unit vector; x ahead, y left.
struct Direction {
  double x = 1, y = 0;
};
inline Direction DirectionOf(double angle_rad) {
  Direction direction;
  coopdyn_sincos(angle_rad, &direction.y, &direction.x);
  return direction;
}

/// A number in [0, 1) that depends only on its arguments: the same in every run and on every thread.
inline double Random(std::uint64_t seed, std::uint32_t robot, std::uint64_t step, std::uint32_t use = 0) {
  std::uint64_t x = seed;
  for (const std::uint64_t part : {std::uint64_t{robot}, step, std::uint64_t{use}}) {
    x += part + 0x9e3779b97f4a7c15;  // splitmix64
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    x ^= x >> 31;
  }
  return static_cast<double>(x >> 11) * 0x1p-53;
}

}  // namespace coopdyn
