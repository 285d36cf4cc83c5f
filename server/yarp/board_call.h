// SPDX-License-Identifier: MIT
// Parses the arguments of a control board's words. Pure functions; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "server/yarp/board.h"
#include "server/yarp/bottle.h"

namespace coopdyn {

/// The joints that a word applies to, which determine its arguments.
enum class BoardScope {
  kBoard,    // nothing
  kOne,      // joint, value …
  kAll,      // (value …)
  kGroup,    // (joint …), (value …)
  kCounted,  // count, (joint …), (value …)
};
struct BoardWord {
  std::string_view word;
  BoardItem item = BoardItem::kNothing;
  BoardScope scope = BoardScope::kBoard;
};

/// The call of `word`, with the items of `request` from `at` on as its arguments.
BoardCall MakeBoardCall(const BoardWord& word, bool tells, const Bottle& request, std::size_t at);
/// The same with joints and values apart: joints in `head` from `at` on, values in `body`.
BoardCall MakeBoardCall(const BoardWord& word, const Bottle& head, std::size_t at, const Bottle& body);
/// The word of a string or vocab, or of the number that YARP 4 sends for a vocab.
std::string WordOf(const BottleValue& value);
/// A call that is refused, with the reason.
BoardCall RefuseBoardCall(std::string why);

inline constexpr const char* kNoBoardPwm = "motors have no PWM here: use the modes pos, posd, vel and torq";
inline constexpr const char* kNoBoardCurrent = "motors have no currents here: torques are under torq";
inline constexpr const char* kNoBoardPid = "the servo for positions is the only PID: pos";

/// Finds `word` in `words`; null if absent.
template <std::size_t count>
const BoardWord* FindBoardWord(const BoardWord (&words)[count], std::string_view word) {
  for (const BoardWord& each : words) {
    if (each.word == word) return &each;
  }
  return nullptr;
}

}  // namespace coopdyn
