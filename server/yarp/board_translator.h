// SPDX-License-Identifier: MIT
// The input ports of a control board: rpc:i, nws/rpc:i and command:i.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/yarp/board.h"
#include "server/yarp/board_rpc.h"
#include "server/yarp/board_words.h"
#include "server/yarp/translator.h"

namespace coopdyn {

/// First asks the module for its state (get_board), then sends the resulting commands.
class BoardTranslator final : public YarpTranslator {
 public:
  enum class Language { kWords, kRpc, kStream };
  explicit BoardTranslator(Language language) : language_(language) {}

  Decoded Decode(const Bottle& request) override;
  std::optional<Message> Next(const Message& reply) override;
  YarpAnswer Reply(const Message& reply) override;

 private:
  const Language language_;
  BoardClient client_;
  BoardRequest words_;  // for kWords
  BoardRpc rpc_;        // for kRpc
  BoardCall call_;
  BoardAnswer answer_;
  double time_s_ = 0;
  bool asked_ = false;    // the state was requested
  std::size_t sent_ = 0;  // number of answer_.commands sent
  std::int32_t count_ = 0;
};

}  // namespace coopdyn
