// SPDX-License-Identifier: MIT
// The first byte of an input chooses the YARS protocol; the rest are datagrams, each after its length, or the
// bytes of a TCP connection. For any input, a robot's side makes only permitted requests, and never hangs.

// link: coopdyn_yars coopdyn_net coopdyn_base coopdyn_protocol

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "protocol/command_ids.h"
#include "protocol/module_tables.h"
#include "server/yars/tcp_encoding.h"
#include "server/yars/udp_talk.h"
#include "tests/server/devices/fake_client.h"

namespace {

using namespace coopdyn;

/// A channel of three motors and four values.
Message Channel() {
  Message reply = ReplyTo(command::kGetChannel, "a b c w x y z");
  reply.params = {3, 4, 1, 2};
  for (int i = 0; i < 7; ++i)
    reply.data.insert(reply.data.end(), {-1, 1, -1, 1, i == 6 ? 1.0 : 0.0, 1.0 + i % 2});
  return reply;
}

Message Answer(const Message& request) {
  if (request.command == command::kGetChannel) return Channel();
  Message reply = ReplyTo(request.command);
  reply.data = {1, 2, 3, 4, 0.1, 10};
  return reply;
}

void Check(const Message& request) {
  static const CommandTable table = ChannelTable();
  if (table.Find(request.command) == nullptr) std::abort();
}

void TalkUdp(std::string_view input) {
  YarsUdpTalk talk;
  while (input.size() > 1) {
    const std::size_t size =
        static_cast<unsigned char>(input[0]) * 8U + static_cast<unsigned char>(input[1]) % 8U;
    input.remove_prefix(2);
    const std::string_view datagram = input.substr(0, size);
    input.remove_prefix(datagram.size());
    YarsUdpTalk::Action action = talk.Take(datagram);
    for (int rounds = 0; talk.waits(); ++rounds) {
      if (rounds > 10) std::abort();
      if (action.order) {
        action = talk.Done(ReplyTo(0));
      } else {
        if (!action.request) std::abort();
        Check(*action.request);
        action = talk.Answer(Answer(*action.request));
      }
    }
  }
}

struct World final : YarsWorld {
  void Ask(YarsOrder /*order*/, const Connection& /*asker*/,
           std::function<void(const Message&)> done) override {
    done(ReplyTo(0));
  }
};

struct Module final : Endpoint {
  const std::string& path() const override { return name; }
  const CommandTable& table() const override { return commands; }
  void OnRequest(Connection& /*connection*/, Message /*request*/, ReplyFunction /*reply*/) override {}

  std::string name = "/r/channel";
  CommandTable commands = ChannelTable();
};

void TalkTcp(std::string_view input) {
  static World world;
  static Module module;
  static const FakeClient client(module, 1);
  const std::unique_ptr<Encoding> encoding = YarsTcpEncodingKind(world).make(module);
  std::string out;
  while (!input.empty()) {
    Incoming incoming = encoding->Decode(input);
    if (incoming.ask) incoming.ask(client, [](const Message&) {});
    if (incoming.status == DecodeStatus::kMessage) {
      Check(incoming.message);
      encoding->Reply(Answer(incoming.message), out);
    }
    if (incoming.consumed == 0) return;
    input.remove_prefix(incoming.consumed);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view input(reinterpret_cast<const char*>(data), size);
  if (input.empty()) return 0;
  const bool udp = input[0] % 2 == 0;
  input.remove_prefix(1);
  udp ? TalkUdp(input) : TalkTcp(input);
  return 0;
}
