// SPDX-License-Identifier: MIT
#include "server/physics/ode.h"

#include <array>
#include <cstdarg>
#include <cstdio>
#include <utility>

namespace coopdyn {

namespace {

// ODE ends the process if its error handler returns, so the handler throws.
[[noreturn]] void ThrowOdeError(int number, const char* message, va_list arguments) {
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), message, arguments);
  throw OdeError("ODE error " + std::to_string(number) + ": " + text.data());
}

thread_local bool complained = false;  // ODE gives its handlers no other place

void NoteOdeMessage(int, const char*, va_list) {
  complained = true;
}

bool InitLibrary() {
  // Never closed: the per-thread data of other threads may live as long as the process.
  dInitODE2(0);
  dSetErrorHandler(&ThrowOdeError);
  dSetDebugHandler(&ThrowOdeError);
  dSetMessageHandler(&NoteOdeMessage);
  return true;
}

}  // namespace

void EnsureOde() {
  [[maybe_unused]] static const bool library = InitLibrary();
  [[maybe_unused]] static thread_local const bool thread = dAllocateODEDataForThread(dAllocateMaskAll) != 0;
}

bool TakeOdeComplaint() {
  return std::exchange(complained, false);
}

}  // namespace coopdyn
