// SPDX-License-Identifier: MIT
// Requests of YARP 4 programs (controlBoard_nwc_yarp) to a control board: Thrift calls in Bottles, with
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
  /// Fields after the success code. d, i, b, s: a number, whole number, truth value or string of one joint;
  /// D, I: lists for all joints; t, T: times; others: see board_rpc.cc.
  std::string_view shape = {};
  std::optional<YarpAnswer> fixed = {};  // the whole answer
};

BoardRpc ReadBoardRpc(const Bottle& request);
/// The bytes of the reply, with YARP 4's tags.
std::string BoardRpcReply(const BoardRpc& rpc, const BoardAnswer& answer, double time_s);

}  // namespace coopdyn
