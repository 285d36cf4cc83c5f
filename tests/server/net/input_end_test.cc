// SPDX-License-Identifier: MIT
// The end of a client's input, detected by another thread while the connection's thread is busy.
#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <utility>

#include "held_thread.h"
#include "server_fixture.h"

namespace coopdyn {
namespace {

using ::testing::HasSubstr;

class InputEndTest : public ServerFixture {
 protected:
  /// Of the only connection.
  std::shared_ptr<InputEnd> End() {
    EXPECT_TRUE(Sees("open"));
    std::shared_ptr<InputEnd> end;
    thread_.Call([&] { end = endpoint_.connections().begin()->second->input_end(); });
    return end;
  }
  bool SeesNothingYet() { return endpoint_.Count("input ended") == 0 && endpoint_.Count("closed") == 0; }
};

TEST_F(InputEndTest, AConnectionThatLivesHasNone) {
  TestClient client = Connect();
  const auto end = End();
  EXPECT_FALSE(end->Look());
  client.Send("hold 1\n");
  ASSERT_TRUE(Sees("request"));
  client.Send("echo 2\n");
  EXPECT_FALSE(end->Look());
  EXPECT_FALSE(end->is_known());
}

TEST_F(InputEndTest, AClosedConnectionIsSeen) {
  TestClient tcp = Connect();
  const auto end = End();
  const HeldThread busy(thread_);
  tcp.Close();
  EXPECT_TRUE(Eventually([&] { return end->Look(); }));
  EXPECT_TRUE(end->is_known());
  EXPECT_TRUE(SeesNothingYet());
}

TEST_F(InputEndTest, AClosedLocalSocketIsSeen) {
  TestClient local = ConnectPair();
  const auto end = End();
  const HeldThread busy(thread_);
  EXPECT_FALSE(end->Look());
  local.Close();
  EXPECT_TRUE(Eventually([&] { return end->Look(); }));
  EXPECT_TRUE(SeesNothingYet());
}

TEST_F(InputEndTest, AResetIsSeen) {
  TestClient client = Connect();
  const auto end = End();
  {
    const HeldThread busy(thread_);
    client.Reset();
    EXPECT_TRUE(Eventually([&] { return end->Look(); }));
    EXPECT_TRUE(SeesNothingYet());
  }
  EXPECT_TRUE(NoSessions()) << "the session sees it, too";
}

TEST_F(InputEndTest, AnEndBehindUnreadRequestsIsSeenAndTheyAreReadAllTheSame) {
  TestClient client = Connect();
  const auto end = End();
  {
    const HeldThread busy(thread_);
    client.Send("echo 1\necho 2\n");
    EXPECT_FALSE(end->Look());
    client.EndInput();
    EXPECT_TRUE(Eventually([&] { return end->Look(); }));
    EXPECT_TRUE(SeesNothingYet());
  }
  EXPECT_THAT(client.Line(), HasSubstr("500 0 3 1.0"));
  EXPECT_THAT(client.Line(), HasSubstr("500 0 3 2.0"));
  EXPECT_EQ(client.Rest(), "");
  EXPECT_EQ(endpoint_.Count("input ended"), 1);
}

TEST_F(InputEndTest, WhoIsClosedByTheDaemonHasEndedBeforeItIsToldSo) {
  TestClient client = Connect();
  const auto end = End();
  thread_.Call([&] {
    endpoint_.connections().begin()->second->Close("taken over");
    EXPECT_TRUE(end->is_known());
    EXPECT_TRUE(SeesNothingYet());
  });
  EXPECT_THAT(client.Rest(), HasSubstr("taken over"));
}

TEST_F(InputEndTest, IsKnownWhenTheServerHasGone) {
  TestClient client = Connect();
  const auto end = End();
  thread_.Call([this] { server_.reset(); });
  EXPECT_TRUE(end->Look());
}

}  // namespace
}  // namespace coopdyn
