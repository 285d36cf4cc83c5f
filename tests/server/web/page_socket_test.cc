// SPDX-License-Identifier: MIT
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/sensing/sample_frame.h"
#include "web_fixture.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using testing::HasSubstr;
using testing::StartsWith;

/// A page without a browser.
class Page {
 public:
  explicit Page(int port, std::string origin = {}) : socket_(context_) {
    const timeval patience{60, 0};
    auto& tcp = beast::get_lowest_layer(socket_);
    tcp.connect({asio::ip::make_address("127.0.0.1"), static_cast<std::uint16_t>(port)});
    ::setsockopt(tcp.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    socket_.set_option(
        beast::websocket::stream_base::decorator([origin](beast::websocket::request_type& request) {
          if (!origin.empty()) request.set("Origin", origin);
        }));
    socket_.handshake("127.0.0.1:" + std::to_string(port), "/ws", failed);
  }

  void Send(std::string_view text) { socket_.write(asio::buffer(text)); }
  /// The next message.
  std::string Read() {
    beast::flat_buffer buffer;
    boost::system::error_code error;
    socket_.read(buffer, error);
    if (error) return "closed: " + error.message();
    return beast::buffers_to_string(buffer.data());
  }
  /// The next message that is neither the greeting nor a status.
  std::string Next() {
    std::string text = Read();
    while (text.starts_with(R"({"type":)")) text = Read();
    return text;
  }
  std::string Call(std::string_view json) {
    Send(json);
    return Next();
  }

  boost::system::error_code failed;

 private:
  asio::io_context context_;
  beast::websocket::stream<asio::ip::tcp::socket> socket_;
};

TEST(PageSocket, GreetsWithItsRights) {
  WebWorld world;
  Page page(world.port);
  ASSERT_FALSE(page.failed);
  EXPECT_EQ(page.Read(), R"({"type":"hello","version":"1.2.3","trusted":true,"person":1,"pictures":true})");
}

TEST(PageSocket, OtherPagesAreRefused) {
  WebWorld world;
  EXPECT_TRUE(Page(world.port, "http://evil.example").failed);
  EXPECT_FALSE(Page(world.port, "http://127.0.0.1:" + std::to_string(world.port)).failed);
}

TEST(PageSocket, SendsCommandsAndRepliesBothWays) {
  WebWorld world;
  Page page(world.port);
  EXPECT_EQ(
      page.Call(
          R"({"id":1,"module":"/robot1/motors","command":"ping","params":[7],"data":["inf",0.1],"text":""})"),
      R"({"id":1,"module":"/robot1/motors","error":0,"text":"","command":0,"params":[7],"data":["inf",0.1]})");
}

TEST(PageSocket, AMalformedMessageIsAnsweredAndTheSocketLives) {
  WebWorld world;
  Page page(world.port);
  EXPECT_THAT(page.Call("nonsense"), AllOf(StartsWith(R"({"id":null)"), HasSubstr(R"("error":7)")));
  EXPECT_THAT(page.Call(R"({"id":5,"module":"/robot1/motors","command":"ping"})"), HasSubstr(R"("error":0)"));
}

TEST(PageSocket, AllItsCallsToAModuleAreOneClient) {
  WebWorld world;
  Page page(world.port);
  const char* drive = R"({"id":1,"module":"/robot1/motors","command":"set_velocity","data":[0.1,0]})";
  EXPECT_THAT(page.Call(drive), HasSubstr(R"("error":0)"));
  EXPECT_THAT(page.Call(R"({"id":2,"module":"/robot1/motors","line":"set_velocity 0.2 0"})"),
              HasSubstr(R"("line":"0 \"\" 11 1 0 2 0.5 50.0")"));
  Page other(world.port);
  EXPECT_THAT(other.Call(drive), AllOf(HasSubstr(R"("error":6)"), HasSubstr("owned by page 127.0.0.1")));
}

TEST(PageSocket, AClosedPageFreesItsRobots) {
  WebWorld world;
  {
    Page page(world.port);
    page.Call(R"({"id":1,"module":"/robot1/motors","command":"set_velocity","data":[0.1,0]})");
    EXPECT_EQ(world.motors.open_owners, 1);
  }
  EXPECT_TRUE(Eventually([&] { return world.motors.open_owners == 0; }));
}

TEST(PageSocket, AChannelIsAConnectionOfItsOwn) {
  WebWorld world;
  Page page(world.port);
  page.Send(R"({"id":1,"module":"/robot1/motors","command":"stop"})");  // answered only by Release()
  EXPECT_THAT(page.Call(R"({"id":2,"module":"/robot1/motors","channel":"other","command":"ping"})"),
              HasSubstr(R"({"id":2,"module":"/robot1/motors","channel":"other","error":0)"));
  ASSERT_TRUE(Eventually([&] { return world.motors.waiting == 1; }));
  world.modules.Call([&] { world.motors.Release(); });
  EXPECT_THAT(page.Next(), StartsWith(R"({"id":1,)"));
}

TEST(PageSocket, WhatSensorsShowComesWhileItIsWanted) {
  WebWorld world;
  Page page(world.port);
  world.frames.Publish(SampleWorld().Robot(At(0, 0)).MakeFrame());
  page.Send(R"({"type":"sensors","rate":60})");
  EXPECT_THAT(page.Next(), StartsWith("\3"));
  world.frames.Publish(SampleWorld().Robot(At(1, 0)).MakeFrame());
  EXPECT_THAT(page.Next(), StartsWith("\3"));
  page.Send(R"({"type":"sensors","rate":0})");
  const char* ping = R"({"id":1,"module":"/robot1/motors","command":"ping"})";
  page.Call(ping);  // read after the request
  world.frames.Publish(SampleWorld().Robot(At(2, 0)).MakeFrame());
  page.Send(R"({"type":"poses","rate":60})");
  EXPECT_THAT(page.Next(), StartsWith("\2"));
  EXPECT_THAT(page.Call(ping), StartsWith(R"({"id":1)"));
}

TEST(PageSocket, SensorsThatShowTheSameAreNotSentAgain) {
  WebWorld world;
  Page page(world.port);
  world.frames.Publish(SampleWorld().Robot(At(0, 0)).MakeFrame());
  page.Send(R"({"type":"sensors","rate":60})");
  const std::string first = page.Next();
  for (int i = 0; i < 5; ++i) {
    world.frames.Publish(SampleWorld().Robot(At(0, 0)).MakeFrame());
    page.Call(R"({"id":1,"module":"/robot1/motors","command":"ping"})");
  }
  world.frames.Publish(SampleWorld().Robot(At(1, 0)).MakeFrame());
  EXPECT_NE(page.Next(), first);
}

TEST(PageSocket, ClosingAConnectionAnswersWhatWaits) {
  WebWorld world;
  Page page(world.port);
  page.Send(R"({"id":1,"module":"/robot1/motors","command":"stop"})");
  EXPECT_THAT(page.Call(R"({"type":"close","module":"/robot1/motors"})"),
              AllOf(StartsWith(R"({"id":1,)"), HasSubstr(R"("error":5)")));
}

TEST(PageSocket, TheClosingNoticeOfAModuleReachesThePageAndTheNextCallConnectsAgain) {
  WebWorld world;
  Page page(world.port);
  page.Call(R"({"id":1,"module":"/robot1/motors","command":"ping"})");
  world.modules.Call([&] { world.motors_server->CloseAll("another took over"); });
  EXPECT_THAT(page.Next(), AllOf(StartsWith(R"({"push":true)"), HasSubstr("another took over")));
  EXPECT_THAT(page.Call(R"({"id":2,"module":"/robot1/motors","command":"ping"})"), HasSubstr(R"("error":0)"));
}

TEST(PageSocket, PushesComeWithoutId) {
  WebWorld world;
  Page page(world.port);
  page.Call(R"({"id":1,"module":"/robot1/motors","command":"subscribe"})");
  EXPECT_THAT(page.Next(), AllOf(StartsWith(R"({"push":true)"), HasSubstr(R"("command":-12)")));
}

TEST(PageSocket, HelpAndVerboseWorkAsInTelnet) {
  WebWorld world;
  Page page(world.port);
  EXPECT_THAT(page.Call(R"({"id":1,"module":"/robot1/motors","line":"help"})"), HasSubstr("set_velocity"));
  page.Call(R"({"id":2,"module":"/robot1/motors","line":"verbose"})");
  EXPECT_THAT(page.Call(R"({"id":3,"module":"/robot1/motors","line":"get_wheels"})"),
              HasSubstr(R"("note":"# )"));
}

TEST(PageSocket, TheStatusIsAskedOnlyWhileAPageIsOpen) {
  WebWorld world;
  EXPECT_EQ(world.simulation.asked, 0);
  {
    Page page(world.port);
    std::string text = page.Read();
    while (!text.starts_with(R"({"type":"status")")) text = page.Read();
    EXPECT_THAT(text, StartsWith(R"({"type":"status","status":{"mode":"realtime","step":)"));
  }
  EXPECT_TRUE(Eventually([&] { return world.simulation_server->session_count() == 0; }));
}

TEST(PageSocket, AMovedCameraIsShownAtOnceAndAStillWorldIsNotDrawnAgain) {
  WebWorld world;
  Page page(world.port);
  EXPECT_THAT(page.Call(R"({"type":"view","width":320,"height":240})"),
              AllOf(HasSubstr(R"("eye":[-3.0,0.0,2.0])"), HasSubstr("picture 1")));
  page.Send(R"({"type":"shown"})");
  EXPECT_THAT(page.Call(R"({"type":"view","width":320,"height":240,"eye":[1,2,3]})"),
              AllOf(HasSubstr(R"("eye":[1.0,2.0,3.0])"), HasSubstr("picture 2")));
  page.Send(R"({"type":"shown"})");
  world.PublishFrame(2);
  EXPECT_THAT(page.Next(), HasSubstr("picture 3"));
}

TEST(PageSocket, APageThatShowsNothingGetsNothing) {
  WebWorld world;
  Page page(world.port);
  page.Call(R"({"type":"view","width":320,"height":240})");
  world.PublishFrame(2);
  // No "shown": the next message is the reply to a call, sent after the frame.
  EXPECT_THAT(page.Call(R"({"id":1,"module":"/robot1/motors","command":"ping"})"), StartsWith(R"({"id":1,)"));
  EXPECT_EQ(world.painter.drawn, 1);
}

TEST(PageSocket, APageThatNeverReadsHoldsNobodyUp) {
  WebWorld world;
  Page lazy(world.port);
  for (int i = 0; i < 200; ++i) lazy.Send(R"({"id":1,"module":"/robot1/motors","line":"help"})");
  Page page(world.port);
  EXPECT_THAT(page.Call(R"({"id":1,"module":"/robot1/motors","command":"ping"})"), HasSubstr(R"("error":0)"));
}

TEST(PageSocket, FramesThatAreNoWebSocketCloseIt) {
  WebWorld world;
  RawClient client(world.port);
  client.Send(
      "GET /ws HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n");
  EXPECT_THAT(client.ReadUntil("\r\n\r\n"), StartsWith("HTTP/1.1 101"));
  client.Send(std::string(100, '\xff'));
  client.ReadAll();  // ends
  EXPECT_EQ(Fetch(world.port, "GET", "/").status, 200);
}

}  // namespace
}  // namespace coopdyn
