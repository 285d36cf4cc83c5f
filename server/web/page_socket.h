// SPDX-License-Identifier: MIT
// One open page: a WebSocket that carries calls to modules, the status, and pictures. A slow one gets the
// newest status, picture and poses only. Text messages are JSON; a binary one has a type byte: 2 poses
// (pose_stream.h), 1 a picture: uint32 (little-endian) length of a JSON object, that object
// {"time_s":…,"step":…,"eye":[x,y,z],"look":[x,y,z]} or {"error":"…"}, then a JPEG. UI thread.
#pragma once

#include <utility>

#include <boost/asio/steady_timer.hpp>
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
  static constexpr std::size_t kMaxQueuedReplies = 64;  // beyond that nothing more is read
  static constexpr std::size_t kMaxQueuedBytes = std::size_t{8} << 20;
  static constexpr std::size_t kMaxQueuedPushes = 64;  // beyond that the oldest is dropped
  static constexpr std::chrono::seconds kHandshakeTime{15};
  static constexpr std::chrono::seconds kSilence{20};  // a peer that answers no ping for so long is gone

  PageSocket(boost::beast::tcp_stream stream, WebContext& context, PeerInfo peer);

  /// Answers the upgrade that has been checked already.
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
  /// Poses at this rate from now on; 0: none.
  void SendPoses(double rate_hz);
  void AwaitPoses();
  /// The poses of the newest frame, if they are due and not what the viewer has.
  std::string TakePoses();
  void Send(std::string text, bool push = false);
  void WriteNext();
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
  std::string written_;  // what is being written
  std::deque<Outgoing> queue_;
  std::size_t queued_bytes_ = 0;
  std::size_t queued_pushes_ = 0;
  std::size_t dropped_pushes_ = 0;
  std::shared_ptr<const std::string> status_;  // the newest, not yet written
  std::shared_ptr<const std::string> people_;  // likewise
  std::string picture_;                        // likewise
  std::uint64_t person_ = 0;                   // among those who look
  PoseStream poses_;
  boost::asio::steady_timer pose_timer_;
  std::chrono::nanoseconds pose_every_{0};  // 0: none are wanted
  bool poses_due_ = false;
  FramePtr posed_;  // the frame whose poses were taken last
};

}  // namespace coopdyn
