// SPDX-License-Identifier: MIT
// A module's port to which programs talk as to a YARP device.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/command_ids.h"
#include "protocol/module_tables.h"
#include "server/yarp/device_rpc.h"
#include "server/yarp/sensor_samples.h"
#include "tests/server/yarp/hex.h"

namespace coopdyn::device_rpc {

inline constexpr double kHalfTurn = std::numbers::pi;
inline constexpr const char* kAskVersion = "getRemoteProtocolVersion";

inline Message ReplyWith(command::Id command, std::vector<double> data) {
  Message reply = ReplyTo(command);
  reply.data = std::move(data);
  reply.data.insert(reply.data.end(), {12.5, 1250});
  return reply;
}
inline Message Refused(command::Id command) {
  return ErrorReply(command, Error::kOwned, "robot1 is driven by ana");
}
inline std::string AnswerBytes(const YarpAnswer& answer, YarpDialect dialect) {
  if (!answer.bytes.empty()) return answer.bytes;
  std::string bytes;
  EncodeBottle(answer.bottle, dialect, bytes);
  return bytes;
}

/// A module's port that answers queries with reading_, and commands with answer_.
class DeviceRpcTest : public ::testing::Test {
 protected:
  DeviceRpcTest(YarpTalk talk, const char* port, const CommandTable& table, Message reading)
      : reading_(std::move(reading)), device_(MakeDeviceTranslator(talk, port, table)) {}

  YarpAnswer Ask(const std::string& request) {
    const Decoded decoded = device_->Decode(*ParseBottle(request));
    EXPECT_EQ(decoded.status, DecodeStatus::kMessage) << request;
    asked_ = decoded.message;
    told_.clear();
    Message reply = reading_;
    while (const std::optional<Message> next = device_->Next(reply)) {
      told_.push_back(*next);
      reply = answer_.error == 0 ? ReplyTo(next->command) : answer_;
    }
    return device_->Reply(reply);
  }
  std::string Text(const std::string& request) { return BottleText(Ask(request).bottle); }
  /// Encoded as on a binary connection.
  std::string Bytes(const std::string& request, YarpDialect dialect = YarpDialect::k3) {
    return AnswerBytes(Ask(request), dialect);
  }
  void ExpectNoSuchRequest(const std::string& request) {
    EXPECT_THAT(Text(request), ::testing::StartsWith("[fail] \"there is no such request here: ")) << request;
    EXPECT_TRUE(told_.empty()) << request;
  }

  Message reading_;
  Message answer_ = {};  // reply to commands; may be an error of the module
  Message asked_;
  std::vector<Message> told_;
  const std::unique_ptr<YarpTranslator> device_;
};

}  // namespace coopdyn::device_rpc
