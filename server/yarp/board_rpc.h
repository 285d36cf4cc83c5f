// SPDX-License-Identifier: MIT
// How programs of YARP 4 (controlBoard_nwc_yarp) ask a control board: calls of Thrift in Bottles, with
// replies of a fixed shape. Pure functions; any thread.
//
// Names, arguments and shapes follow ControlBoardMsgs.thrift of YARP 4.0.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/yarp/board.h"
#include "server/yarp/bottle.h"
#include "server/yarp/translator.h"

namespace coopdyn {

struct BoardRpc {
  BoardCall call = {};
  /// What follows the code of success: d, i, b, s: a number, whole number, truth value, string of one joint;
  /// D, I: lists of all joints; t, T: times; others as board_rpc.cc tells.
  std::string_view shape = {};
  std::optional<YarpAnswer> fixed = {};  // the whole answer
};

BoardRpc ReadBoardRpc(const Bottle& request);
/// The bytes of the reply, in the tags of YARP 4.
std::string BoardRpcReply(const BoardRpc& rpc, const BoardAnswer& answer, double time_s);

}  // namespace coopdyn
