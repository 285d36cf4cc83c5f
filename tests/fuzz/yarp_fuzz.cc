// SPDX-License-Identifier: MIT
// The first byte of an input is the carrier, the rest the bytes of a YARP program after its hello. A decoded
// Bottle must be encodable and decode again to the same number of values.

// link: coopdyn_yarp

#include <spdlog/spdlog.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "protocol/module_tables.h"
#include "server/yarp/admin.h"
#include "server/yarp/bottle.h"
#include "server/yarp/carrier.h"
#include "server/yarp/datagram.h"
#include "server/yarp/encoding.h"
#include "server/yarp/port_name.h"
#include "server/yarp/translator.h"
#include "tests/server/yarp/port.h"

namespace {

using namespace coopdyn;

void CheckBottle(const Bottle& bottle) {
  std::string bytes;
  EncodeBottle(bottle, YarpDialect::k4, bytes);
  YarpDialect dialect = YarpDialect::k4;
  const std::optional<Bottle> again = DecodeBottle(bytes, dialect);
  if (!again || again->size() != bottle.size()) std::abort();
}

/// A board of two joints, one of which slides. Its requests to its module conform to the commands' table.
void AskBoard(YarpTranslator& board, const Bottle& bottle) {
  static const CommandTable joints = JointsTable();
  Message reply = ReplyTo(board.Decode(bottle).message.command, "turns slides");
  reply.params = {0, 1, 1, 1, 3, 0};
  reply.data.assign(2 * 18 + 2, 1.0);
  for (std::optional<Message> next = board.Next(reply); next; next = board.Next(reply)) {
    if (joints.Find(next->command) == nullptr) std::abort();
    reply = ReplyTo(next->command);
    reply.params = {0};
    reply.data = {1, 100};
  }
  board.Reply(reply);
}

/// The administrative replies of a port, and of the clock's port.
void AskPorts(const Bottle& bottle) {
  AnswerYarpAdmin(bottle, {"/robot1/pose", "/x", "tcp", {}});
  LinkChangeIn(bottle);
  const std::unique_ptr<YarpTranslator> clock = TranslatorOf(kYarpClockRpc, SimulationTable());
  clock->Reply(clock->Decode(bottle).message);
  static const CommandTable joints = JointsTable();
  for (const char* const port : {"/r/arm/rpc:i", "/r/arm/nws/rpc:i", "/r/arm/command:i"})
    AskBoard(*TranslatorOf(port, joints), bottle);
  const std::unique_ptr<YarpTranslator> camera = TranslatorOf("/r/camera/rpc:i", CameraTable());
  Message view = camera->Decode(bottle).message;
  view.data = {64, 48, 32, 32, 31.5, 23.5, 0.1, 10, 25, 12.5, 1250};
  camera->Reply(view);
}

/// A whole connection to each kind of port: its requests to the module are answered with little data or an
/// error.
void Talk(const std::string& bytes, std::uint8_t choice) {
  static const Port ports[] = {
      {"/robot1/motors", MotorsTable()},        {"/world_input_port", WorldTable()},
      {"/clock/rpc", SimulationTable()},        {"/robot1/arm/rpc:i", JointsTable()},
      {"/robot1/arm/nws/rpc:i", JointsTable()}, {"/robot1/arm/command:i", JointsTable()},
      {"/robot1/lidar/rpc:i", LidarTable()},    {"/robot1/camera/rpc", CameraTable()},
      {"/robot1/imu/rpc:o", ImuTable()},        {"/robot1/battery/rpc:i", BatteryTable()}};
  static NameTable names;
  static YarpNetwork network(names, spdlog::default_logger(), {});
  static const Encodings encodings = EncodingsWithYarp(network);
  const EncodingKind* const kind = Choose(encodings, bytes);
  if (kind == nullptr) return;
  const std::unique_ptr<Encoding> encoding = kind->make(ports[choice % std::size(ports)]);
  std::string_view rest = bytes;
  std::string out;
  while (!rest.empty()) {
    const Incoming incoming = encoding->Decode(rest);
    if (incoming.consumed > rest.size()) std::abort();
    rest.remove_prefix(incoming.consumed);
    const bool bad = incoming.status == DecodeStatus::kBad || incoming.status == DecodeStatus::kFatal;
    if (incoming.ask || bad || incoming.status == DecodeStatus::kMessage) {
      Message reply = bad ? incoming.message : ReplyTo(incoming.message.command);
      if (choice >= 128) reply = ErrorReply(reply.command, Error::kNotPossible, "no");
      int left = 100;
      while (const std::optional<Message> next = encoding->Next(reply, out)) {
        if (--left == 0) std::abort();
        reply = ReplyTo(next->command);
      }
      encoding->Reply(reply, out);
    }
    const bool ends = incoming.status == DecodeStatus::kFatal || incoming.status == DecodeStatus::kLeave;
    if (ends || incoming.consumed == 0) return;
  }
}

/// Datagrams of any bytes yield at most these requests.
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
  const std::string_view hello = kHellos[data[0] % 4];
  reader.Next(hello);
  std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  Talk(std::string(hello).append(rest), data[0] / 4 * 4 + rest.size() % 4);
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
