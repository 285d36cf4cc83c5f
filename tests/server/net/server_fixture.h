// SPDX-License-Identifier: MIT
// A module server with a scripted endpoint on its own thread, and clients of it.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "protocol/codec.h"
#include "scripted_endpoint.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/net/io_thread.h"
#include "server/net/module_server.h"
#include "test_client.h"

namespace coopdyn {

class ServerFixture : public ::testing::Test {
 protected:
  explicit ServerFixture(Encodings encodings = StandardEncodings())
      : services_(NullLogger(), clock_, std::move(encodings)) {
    const std::string error = server_->Listen(ListenOn(), 0);
    EXPECT_EQ(error, "");
  }
  ~ServerFixture() override {
    thread_.Call([this] { server_.reset(); });
  }

  static std::vector<std::string> ListenOn() { return {"127.0.0.1"}; }

  TestClient Connect() { return TestClient::Connect(server_->port()); }
  /// A client over a unix socket pair.
  TestClient ConnectPair(std::string already_read = "") {
    auto [ours, theirs] = SocketPair();
    server_->Adopt(theirs.Release(), std::move(already_read), {"pair", true});
    return TestClient(std::move(ours));
  }
  bool Sees(const std::string& event, int times = 1) {
    return Eventually([&] { return endpoint_.Count(event) >= times; });
  }
  /// Releases one held reply.
  void Release() {
    thread_.Call([this] { endpoint_.ReleaseOne(); });
  }
  bool NoSessions() {
    return Eventually([this] { return server_->session_count() == 0; });
  }
  static std::string Frame(std::int32_t command, std::vector<double> data = {}) {
    Message message;
    message.command = command;
    message.data = std::move(data);
    std::string bytes;
    EncodeBinary(message, bytes);
    return bytes;
  }

  SteadyClock clock_;
  NetServices services_;
  ScriptedEndpoint endpoint_;
  IoThread thread_{"test-io", NullLogger()};
  std::unique_ptr<ModuleServer> server_ =
      std::make_unique<ModuleServer>(thread_, endpoint_, services_, "/test");
};

}  // namespace coopdyn
