// SPDX-License-Identifier: MIT
// YARP 3 programs' requests to a control board in words (`[get] [encs]`, `[set] [pos] 0 30`), and the
// streamed commands of YARP 3 and 4. Pure functions; any thread.
//
// The words and the order of replies follow controlBoard_nws_yarp and remote_controlboard of YARP 3.12.
#pragma once

#include <cstdint>
#include <string>

#include "server/yarp/board.h"
#include "server/yarp/bottle.h"

namespace coopdyn {

/// A request with the data for its answer.
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
/// `count`: number of the connection's time stamp.
Bottle BoardWords(const BoardRequest& request, const BoardAnswer& answer, double time_s, std::int32_t count);
/// `[fail]` and the reason.
Bottle BoardFailure(const std::string& why);

/// A message to command:i: (head) (values).
BoardCall ReadBoardStream(const Bottle& message);

}  // namespace coopdyn
