// SPDX-License-Identifier: MIT
// How programs of YARP 3 speak to a control board: requests by word (`[get] [encs]`, `[set] [pos] 0 30`) and
// the commands that stream, of YARP 3 and 4. Pure functions; any thread.
//
// The words and the order of replies follow controlBoard_nws_yarp and remote_controlboard of YARP 3.12.
#pragma once

#include <cstdint>
#include <string>

#include "server/yarp/board.h"
#include "server/yarp/bottle.h"

namespace coopdyn {

/// A request, and what its answer needs of it.
struct BoardRequest {
  enum class Form {
    kFixed,     // `fixed` is the whole answer
    kUnknown,   // [nak]
    kSet,       // [ok]
    kGet,       // [is] word value [tsta] count time [ok]
    kGetAll,    // [is] word (value …) [tsta] count time [ok]
    kPlain,     // [is] word value [ok]
    kPlainAll,  // [is] word (value …) [ok]
    kBare,      // value [tsta] count time [ok]
    kBareAll,   // (value …) [tsta] count time [ok]
  };
  Form form = Form::kUnknown;
  BoardCall call = {};
  BottleValue word = {};  // of the answer
  Bottle fixed = {};
};

BoardRequest ReadBoardWords(const Bottle& request);
/// `count`: of the time stamps of this connection.
Bottle BoardWords(const BoardRequest& request, const BoardAnswer& answer, double time_s, std::int32_t count);
/// `[fail]` and why.
Bottle BoardFailure(const std::string& why);

/// A message to command:i: (head) (values).
BoardCall ReadBoardStream(const Bottle& message);

}  // namespace coopdyn
