// SPDX-License-Identifier: MIT
// A complete controller except for its description, for controllers that fail before they drive.
#pragma once

#include "clients/plugin/controller.h"

namespace {

int instance_of_all = 0;

inline void* Create(const coopdyn_robot*, const double*, char*, size_t) {
  return &instance_of_all;
}
inline void Reset(void*, uint64_t) {}
inline void Step(void*, const coopdyn_readings*, coopdyn_command* command) {
  command->forward_m_s = 0.1;
}
inline void Save(const void*, void*) {}
inline void Restore(void*, const void*) {}
inline void Destroy(void*) {}

/// All functions, with this `describe`.
inline coopdyn_controller With(const coopdyn_description* (*describe)()) {
  return {COOPDYN_CONTROLLER_VERSION, describe, Create, Reset, Step, Save, Restore, Destroy};
}

}  // namespace
