// SPDX-License-Identifier: MIT
// One open page: a WebSocket that carries calls to modules, the status, poses and pictures. A slow page
// receives only the newest status, poses and picture. Text messages are JSON; a binary one starts with its
// type: byte 2 for poses (pose_stream.h); byte 3 for sensors (sensor_message.h); byte 1 for a picture,
// followed by the uint32 (little-endian) length of a JSON object, that object
// {"time_s":…,"step":…,"eye":[x,y,z],"look":[x,y,z]} or {"error":"…"}, and a JPEG. UI thread.
#pragma once

#include <utility>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <string>

#include "server/web/frame_cadence.h"
#include "server/web/live_view.h"
#include "server/web/page_bridge.h"
#include "server/web/pose_stream.h"
#include "server/web/web_context.h"

namespace coopdyn {

class PageSocket : public WebConnection,
                   public StatusWatcher,
                   public PeopleWatcher,
                   public std::enable_shared_from_this<PageSocket> {
 public:
  static constexpr std::size_t kMaxMessageBytes = std::size_t{20} << 20;  // an upload of 16 MiB as JSON
  static constexpr std::size_t kMaxStrangersMessageBytes = std::size_t{1} << 20;  // without the token
  static constexpr std::size_t kMaxQueuedReplies = 64;  // beyond this, reading pauses
  static constexpr std::size_t kMaxQueuedBytes = std::size_t{8} << 20;
  static constexpr std::size_t kMaxQueuedPushes = 64;  // beyond this, the oldest is dropped
  /// At the end of the address: no status comes, and others do not see this page among the people. For walls.
  static constexpr const char* kOnlyPoses = "only=poses";
  static constexpr std::chrono::seconds kHandshakeTime{15};
  static constexpr std::chrono::seconds kSilence{20};  // without an answer to pings; then the peer is gone

  PageSocket(boost::beast::tcp_stream stream, WebContext& context, PeerInfo peer);

  /// Accepts `upgrade`, which FindRoute() has checked.
  void Start(boost::beast::http::request<boost::beast::http::string_body> upgrade);
  void Close() override;
  void OnStatus(const std::shared_ptr<const std::string>& status) override;
  void OnPeople(const std::shared_ptr<const std::string>& people) override;

 private:
  struct Outgoing {
    std::string text;
    bool push = false;
  };

  void Read();
  void OnMessage(std::string_view text);
  void TakeToken(const std::string& token);
  void OnHello(const PageHello& hello);
  void OnReply(PageReply reply);
  void OnPicture(const ImageResult& result);
  /// The pose message of the newest frame; empty if none is due or nothing changed.
  std::string TakePoses();
  /// Likewise of what its sensors show; null if none.
  SensorFeed::Message TakeSensors();
  void Send(std::string text, bool push = false);
  void WriteNext();
  /// Sends `bytes`, which `keep` owns, or this.
  void Write(std::string_view bytes, bool binary, SensorFeed::Message keep = nullptr);
  bool overfull() const { return queue_.size() > kMaxQueuedReplies || queued_bytes_ > kMaxQueuedBytes; }

  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  WebContext& context_;
  boost::beast::http::request<boost::beast::http::string_body> upgrade_;
  boost::beast::flat_buffer buffer_;
  PageBridge bridge_;
  LiveView view_;
  bool open_ = false;
  bool reading_ = false;
  bool writing_ = false;
  std::string written_;  // the message being written
  std::deque<Outgoing> queue_;
  std::size_t queued_bytes_ = 0;
  std::size_t queued_pushes_ = 0;
  std::size_t dropped_pushes_ = 0;
  std::shared_ptr<const std::string> status_;  // the newest; null once written
  std::shared_ptr<const std::string> people_;  // likewise
  std::string picture_;                        // the newest; empty once written
  std::uint64_t person_ = 0;                   // this page in context_.people
  PoseStream poses_;
  FrameCadence pose_cadence_, sensor_cadence_;
  SensorFeed::Message sensors_;  // as sent last
};

}  // namespace coopdyn
