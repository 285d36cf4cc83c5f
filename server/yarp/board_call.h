// SPDX-License-Identifier: MIT
// The arguments of a word that a control board is asked or told with. Pure functions; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "server/yarp/board.h"
#include "server/yarp/bottle.h"

namespace coopdyn {

/// Which joints a word is about, and so what follows it.
enum class BoardScope {
  kBoard,    // nothing
  kOne,      // joint, value …
  kAll,      // (value …)
  kGroup,    // (joint …), (value …)
  kCounted,  // how many, (joint …), (value …)
};
struct BoardWord {
  std::string_view word;
  BoardItem item = BoardItem::kNothing;
  BoardScope scope = BoardScope::kBoard;
};

/// The call that `word` makes, its arguments being the items of `request` from `at` on.
BoardCall MakeBoardCall(const BoardWord& word, bool tells, const Bottle& request, std::size_t at);
/// The values of a call of `word` come apart from its joints: `head` from `at` on, and `body`.
BoardCall MakeBoardCall(const BoardWord& word, const Bottle& head, std::size_t at, const Bottle& body);
/// The word of a string or vocab, or of the number that YARP 4 writes for a vocab.
std::string WordOf(const BottleValue& value);
/// A call that cannot be, and why.
BoardCall RefuseBoardCall(std::string why);

inline constexpr const char* kNoBoardPwm = "motors have no PWM here: use the modes pos, posd, vel and torq";
inline constexpr const char* kNoBoardCurrent = "motors have no currents here: torques are under torq";
inline constexpr const char* kNoBoardPid = "the servo for positions is the only PID: pos";

/// The first of `words` that is `word`; null: none.
template <std::size_t count>
const BoardWord* FindBoardWord(const BoardWord (&words)[count], std::string_view word) {
  for (const BoardWord& each : words) {
    if (each.word == word) return &each;
  }
  return nullptr;
}

}  // namespace coopdyn
