// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "web_fixture.h"

namespace coopdyn {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

HttpReply Call(const WebWorld& world, std::string_view json, std::string_view headers = {}) {
  return Fetch(world.port, "POST", "/api/call", json, headers);
}

TEST(WebServer, ServesThePageWithItsGuards) {
  WebWorld world;
  const HttpReply reply = Fetch(world.port, "GET", "/");
  EXPECT_EQ(reply.status, 200);
  EXPECT_THAT(reply.body, HasSubstr("<!doctype html>"));
  EXPECT_THAT(reply.header, HasSubstr("Content-Security-Policy: default-src 'self'"));
  EXPECT_THAT(reply.header, HasSubstr("Content-Type: text/html; charset=utf-8"));
}

TEST(WebServer, HeadHasTheHeaderOnly) {
  WebWorld world;
  const HttpReply get = Fetch(world.port, "GET", "/style.css");
  const HttpReply head = Fetch(world.port, "HEAD", "/style.css");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
  EXPECT_THAT(head.header, HasSubstr("Content-Length: " + std::to_string(get.body.size()) + "\r\n"));
}

TEST(WebServer, AnswersSeveralRequestsOnOneConnection) {
  WebWorld world;
  RawClient client(world.port);
  const std::string request = "GET /api/scenarios HTTP/1.1\r\nHost: localhost\r\n\r\n";
  client.Send(request + request);  // the second before the reply to the first
  for (int i = 0; i < 2; ++i)
    EXPECT_THAT(client.ReadUntil("[\"classroom\",\"corridor\"]\n"), StartsWith("HTTP/1.1 200"));
}

TEST(WebServer, AnswersAPeerThatHasClosedItsSide) {
  WebWorld world;
  RawClient client(world.port);
  client.Send("GET /api/status HTTP/1.0\r\n\r\n");
  client.EndInput();
  EXPECT_THAT(client.ReadAll(), HasSubstr("\"mode\":\"realtime\""));
}

TEST(WebServer, TellsTheModules) {
  WebWorld world;
  const HttpReply reply = Fetch(world.port, "GET", "/api/modules");
  EXPECT_THAT(reply.body, StartsWith(R"({"name_port":10000,"version":"1.2.3","modules":[)"));
  EXPECT_THAT(reply.body,
              HasSubstr(R"({"name":"/robot1/motors","address":null,"port":10002,"external":false})"));
  EXPECT_THAT(reply.body,
              HasSubstr(R"({"name":"/elsewhere","address":"10.0.0.9","port":4711,"external":true})"));
}

TEST(WebServer, CallsAModule) {
  WebWorld world;
  const HttpReply reply = Call(
      world,
      R"({"id":1,"module":"/robot1/motors","command":"set_velocity","params":[],"data":[0.2,0],"text":""})");
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(
      reply.body,
      R"({"id":1,"module":"/robot1/motors","error":0,"text":"","command":11,"params":[0],"data":[0.5,50.0]})"
      "\n");
}

TEST(WebServer, ACallFreesWhatItTook) {
  WebWorld world;
  Call(world, R"({"module":"/robot1/motors","command":11,"data":[0.2,0]})");
  EXPECT_TRUE(Eventually([&] { return world.motors.closed == 1; }));
  EXPECT_EQ(world.motors.open_owners, 0);
}

TEST(WebServer, ACallMayBeALine) {
  WebWorld world;
  const HttpReply reply = Call(world, R"({"id":1,"module":"/robot1/motors","line":"get_wheels"})");
  EXPECT_THAT(reply.body, HasSubstr(R"("data":["inf",-0.25,0.5,50.0])"));
  EXPECT_THAT(reply.body, HasSubstr(R"("line":"0 \"\" 12 0 4 inf -0.25 0.5 50.0)"));
}

TEST(WebServer, ErrorsOfModulesAndNamesComeAsReplies) {
  WebWorld world;
  EXPECT_THAT(Call(world, R"({"module":"/robot1/motor","command":0})").body,
              AllOf(HasSubstr(R"("error":10)"), HasSubstr("did you mean /robot1/motors?")));
  EXPECT_THAT(Call(world, R"({"module":"/robot1/motors","command":"set_velocty"})").body,
              AllOf(HasSubstr(R"("error":1)"), HasSubstr("did you mean set_velocity?")));
  EXPECT_THAT(Call(world, R"({"module":"/robot1/motors","line":"set_velocity 0,5 1"})").body,
              AllOf(HasSubstr(R"("error":7)"), HasSubstr("write 0.5")));
  EXPECT_THAT(Call(world, R"({"module":"/elsewhere","command":0})").body, HasSubstr("another program"));
}

TEST(WebServer, BadCallsAre400WithAReason) {
  WebWorld world;
  for (const char* json : {"{", "[1]", R"({"module":"/m"})", R"({"type":"view"})"}) {
    const HttpReply reply = Call(world, json);
    EXPECT_EQ(reply.status, 400) << json;
    EXPECT_NE(reply.body, "") << json;
  }
}

TEST(WebServer, OtherPagesCannotCall) {
  WebWorld world;
  EXPECT_EQ(
      Call(world, R"({"module":"/simulation","command":"run"})", "Origin: http://evil.example\r\n").status,
      403);
  EXPECT_EQ(Call(world, R"({"module":"/simulation","command":"run"})", "Host: evil.example\r\n").status, 403);
  EXPECT_EQ(Call(world, R"({"module":"/simulation","command":"run"})", "Content-Type: text/plain\r\n").status,
            415);
}

TEST(WebServer, MalformedRequestsAreAnsweredAndClosed) {
  WebWorld world;
  for (const std::string& bytes :
       {std::string("nonsense\r\n\r\n"), std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nHost\r\n\r\n"), std::string("\0\1\2\3\r\n\r\n", 8),
        std::string("POST /api/call HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n")}) {
    RawClient client(world.port);
    client.Send(bytes);
    EXPECT_THAT(client.ReadAll(), StartsWith("HTTP/1.1 400")) << bytes;
  }
  EXPECT_EQ(Fetch(world.port, "GET", "/").status, 200);
}

TEST(WebServer, TooLongHeadersAre431) {
  WebWorld world;
  EXPECT_EQ(Fetch(world.port, "GET", "/", {}, "X-Long: " + std::string(20000, 'x') + "\r\n").status, 431);
}

TEST(WebServer, TooLongBodiesAre413) {
  WebWorld world;
  RawClient client(world.port);
  client.Send(
      "POST /api/call HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
      "Content-Length: 17000000\r\n\r\n{");
  EXPECT_THAT(client.ReadUntil("\r\n\r\n"), StartsWith("HTTP/1.1 413"));
}

TEST(WebServer, AWaitingCallHoldsNobodyElse) {
  WebWorld world;
  RawClient waiting(world.port);
  const std::string body = R"({"id":1,"module":"/robot1/motors","command":"stop"})";
  waiting.Send(
      "POST /api/call HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: " +
      std::to_string(body.size()) + "\r\n\r\n" + body);
  ASSERT_TRUE(Eventually([&] { return world.motors.waiting == 1; }));
  EXPECT_EQ(Fetch(world.port, "GET", "/api/status").status, 200);
  world.modules.Call([&] { world.motors.Release(); });
  EXPECT_THAT(waiting.ReadUntil("}\n"), HasSubstr(R"("command":14)"));
}

TEST(WebServer, DrawsASnapshot) {
  WebWorld world;
  const HttpReply reply = Fetch(world.port, "GET", "/snapshot.png?w=320&h=200");
  EXPECT_EQ(reply.status, 200);
  EXPECT_THAT(reply.header, HasSubstr("Content-Type: image/png"));
  EXPECT_THAT(reply.body, StartsWith("picture "));
  const HttpReply wrong = Fetch(world.port, "GET", "/snapshot.png?w=huge");
  EXPECT_EQ(wrong.status, 400);
  EXPECT_THAT(wrong.body, HasSubstr("w=640"));
}

TEST(WebServer, AStreamDrawsOnlyWhatIsNewAndLookedAt) {
  WebWorld world;
  RawClient viewer(world.port);
  viewer.Send("GET /view.mjpg?w=320&h=200 HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_THAT(viewer.ReadUntil("picture 1"), HasSubstr("multipart/x-mixed-replace"));
  // The world stands still: the next reply to another client is picture 2, in any order.
  EXPECT_THAT(Fetch(world.port, "GET", "/snapshot.png").body, "picture 2");
  world.PublishFrame(2);
  viewer.ReadUntil("picture 3");
}

TEST(WebServer, WithoutRenderingThereAreNoPictures) {
  WebWorld world;
  WebServer blind(WebWorld::DefaultOptions(), world.names, world.frames, nullptr, world.services);
  ASSERT_EQ(blind.Listen({"127.0.0.1"}, 0), "");
  EXPECT_EQ(Fetch(blind.port(), "GET", "/snapshot.png").status, 503);
  EXPECT_THAT(Fetch(blind.port(), "GET", "/view.mjpg").body, HasSubstr("--no-render"));
}

TEST(WebServer, IdleConnectionsHoldNobodyUp) {
  WebWorld world;
  std::vector<std::unique_ptr<RawClient>> idle;
  for (int i = 0; i < 200; ++i) {
    idle.push_back(std::make_unique<RawClient>(world.port));
    if (i % 2 == 0) idle.back()->Send("GET / HT");
  }
  EXPECT_EQ(Fetch(world.port, "GET", "/api/status").status, 200);
}

TEST(WebServer, TooManyConnectionsAreRefusedPolitely) {
  WebWorld world;
  std::vector<std::unique_ptr<RawClient>> idle;
  for (int i = 0; i < 256; ++i) idle.push_back(std::make_unique<RawClient>(world.port));
  RawClient late(world.port);
  EXPECT_THAT(late.ReadUntil("\r\n\r\n"),
              AllOf(StartsWith("HTTP/1.1 503"), HasSubstr("Retry-After: 15\r\n")));
}

TEST(WebServer, AHeaderThatComesByteByByteIsNotWaitedForLonger) {
  WebOptions options = WebWorld::DefaultOptions();
  options.header_time = std::chrono::milliseconds(200);
  WebWorld world(std::move(options));
  RawClient slow(world.port);
  slow.Send("GET / HTTP/1.1\r\nX-Slow: ");
  constexpr int kMostBytes = 5000;  // the whole header would be too long with 16 KiB
  int sent = 0;
  for (; sent < kMostBytes && !slow.HasEnded(std::chrono::milliseconds(10)); ++sent) slow.Send("x");
  EXPECT_LT(sent, kMostBytes);
  EXPECT_EQ(slow.ReadAll(), "");
}

TEST(WebServer, StopsWhileRequestsWait) {
  auto world = std::make_unique<WebWorld>();
  RawClient waiting(world->port);
  const std::string body = R"({"id":1,"module":"/robot1/motors","command":"stop"})";
  waiting.Send(
      "POST /api/call HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: " +
      std::to_string(body.size()) + "\r\n\r\n" + body);
  ASSERT_TRUE(Eventually([&] { return world->motors.waiting == 1; }));
  world->web->Stop();
  EXPECT_EQ(waiting.ReadAll(), "");
}

}  // namespace
}  // namespace coopdyn
