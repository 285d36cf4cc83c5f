// SPDX-License-Identifier: MIT
#include "server/yarp/network.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <future>
#include <memory>
#include <string>

#include "server/net/encoding.h"

namespace coopdyn {
namespace {

using ::testing::StartsWith;

/// The reply to a sender of datagrams to /robot1/motors from a daemon that listens at `address`.
Message AnswerAt(const std::string& address) {
  NameTable names;
  names.AddOwn(
      "/robot1/motors", 10002,
      [](int fd, const std::string&, const PeerInfo&, const std::unique_ptr<Encoding>&) { ::close(fd); });
  std::promise<Message> answer;
  YarpNetwork network(names, spdlog::default_logger(), {{}, "127.0.0.1", address, {}});
  network.Accept("/sender", "/robot1/motors", YarpAsker::kTrusted,
                 [&answer](Message message) { answer.set_value(std::move(message)); });
  return answer.get_future().get();
}

TEST(YarpNetwork, DatagramsComeInAtAnAddressOrAtAName) {
  for (const char* host : {"127.0.0.1", "localhost", "0.0.0.0"}) {
    const Message answer = AnswerAt(host);
    EXPECT_EQ(answer.error, 0) << host << ": " << answer.text;
    EXPECT_GT(answer.params.at(0), 0) << host;
  }
}

TEST(YarpNetwork, AnAddressThatCannotBeIsTold) {
  for (const char* host : {"198.51.100.1", "no.such.host.invalid"})
    EXPECT_THAT(AnswerAt(host).text, StartsWith("Cannot take datagrams: ")) << host;
}

}  // namespace
}  // namespace coopdyn
