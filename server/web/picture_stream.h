// SPDX-License-Identifier: MIT
// /view.mjpg: pictures one after the other, the next one only when the last was written, so that a slow
// viewer costs nothing. UI thread.
#pragma once

#include <utility>

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <memory>
#include <string>

#include "server/web/web_context.h"

namespace coopdyn {

class PictureStream : public WebConnection, public std::enable_shared_from_this<PictureStream> {
 public:
  static constexpr std::chrono::seconds kWriteTime{30};  // for one picture; then the viewer is given up
  static constexpr std::chrono::milliseconds kIdlePeriod{50};
  /// A world that stands still is shown again after this, which finds viewers that have gone.
  static constexpr std::chrono::seconds kRepeat{2};

  PictureStream(boost::asio::ip::tcp::socket socket, WebContext& context, ImageRequest image);

  /// Answers; with `head_only` no more than the header.
  void Start(bool head_only);
  void Close() override;

 private:
  void Ask();
  void OnPicture(const ImageResult& result);
  void Write();
  void WaitForNews();
  /// Ends with the viewer's side.
  void WatchViewer();

  boost::asio::ip::tcp::socket socket_;
  WebContext& context_;
  const ImageRequest image_;
  boost::asio::steady_timer timer_;
  std::string part_;
  std::array<char, 512> ignored_;
  SceneMoment asked_at_;
  bool shown_ = false;  // a picture at all
  std::chrono::steady_clock::time_point written_at_;
};

}  // namespace coopdyn
