// SPDX-License-Identifier: MIT
// The first byte of an input is the carrier, the rest what a program of YARP sends after its hello. A Bottle
// that is read must be written and read again with as many values.

// link: coopdyn_yarp

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include "protocol/module_tables.h"
#include "server/yarp/admin.h"
#include "server/yarp/bottle.h"
#include "server/yarp/carrier.h"
#include "server/yarp/datagram.h"
#include "server/yarp/port_name.h"
#include "server/yarp/translator.h"

namespace {

using namespace coopdyn;

void CheckBottle(const Bottle& bottle) {
  std::string bytes;
  EncodeBottle(bottle, YarpDialect::k4, bytes);
  YarpDialect dialect = YarpDialect::k4;
  const std::optional<Bottle> again = DecodeBottle(bytes, dialect);
  if (!again || again->size() != bottle.size()) std::abort();
}

/// A board of two joints, of which one slides. What it sends to its module is as the commands' table says.
void AskBoard(YarpTranslator& board, const Bottle& bottle) {
  static const CommandTable joints = JointsTable();
  Message reply = ReplyTo(board.Decode(bottle).message.command, "turns slides");
  reply.params = {0, 1, 1, 1, 3, 0};
  reply.data.assign(2 * 17 + 2, 1.0);
  for (std::optional<Message> next = board.Next(reply); next; next = board.Next(reply)) {
    if (joints.Find(next->command) == nullptr) std::abort();
    reply = ReplyTo(next->command);
    reply.params = {0};
    reply.data = {1, 100};
  }
  board.Reply(reply);
}

/// What a port answers about itself, and that of the clock.
void AskPorts(const Bottle& bottle) {
  AnswerYarpAdmin(bottle, {"/robot1/pose", "/x", "tcp", {}});
  LinkChangeIn(bottle);
  const std::unique_ptr<YarpTranslator> clock = TranslatorOf(kYarpClockRpc, SimulationTable());
  clock->Reply(clock->Decode(bottle).message);
  static const CommandTable joints = JointsTable();
  for (const char* const port : {"/r/arm/rpc:i", "/r/arm/nws/rpc:i", "/r/arm/command:i"})
    AskBoard(*TranslatorOf(port, joints), bottle);
}

/// Datagrams of any bytes give no more than these.
void CheckDatagrams(std::string_view bytes) {
  DatagramJoiner joiner;
  joiner.Add(bytes);
  for (const std::string& datagram : CutIntoDatagrams(bytes)) {
    if (joiner.Add(datagram).size() > bytes.size()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::string_view kHellos[] = {{"YA\xe4\x1e\0\0RP\3\0\0\0/x\0", 15},
                                          {"YA\x64\x1e\0\0RP\3\0\0\0/x\0", 15},
                                          "CONNECT /x\r\n",
                                          "CONNACK /x\r\n"};
  if (size == 0) return 0;
  YarpReader reader;
  reader.Next(kHellos[data[0] % 4]);
  std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  BeginsYarp(rest);
  while (true) {
    const YarpInput input = reader.Next(rest);
    if (input.consumed > rest.size()) std::abort();
    if (input.kind != YarpInput::Kind::kCommand) break;
    if (input.consumed == 0) std::abort();
    rest.remove_prefix(input.consumed);
    YarpDialect dialect = YarpDialect::k3;
    if (const auto bottle =
            reader.is_text() ? ParseBottle(input.payload) : DecodeBottle(input.payload, dialect)) {
      CheckBottle(*bottle);
      AskPorts(*bottle);
    }
  }
  CheckDatagrams(std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
}
