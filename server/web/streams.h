// SPDX-License-Identifier: MIT
// Connections taken over by a long HTTP answer: a stream of pictures, or a file. UI thread.
#pragma once

#include <utility>

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "server/net/unique_fd.h"
#include "server/web/web_context.h"

namespace coopdyn {

/// /view.mjpg: pictures one after the other. Requests the next picture only when the last has been written,
/// so that a slow viewer costs nothing.
class PictureStream : public WebConnection, public std::enable_shared_from_this<PictureStream> {
 public:
  static constexpr std::chrono::seconds kWriteTime{30};  // for one picture; then the connection is closed
  static constexpr std::chrono::milliseconds kIdlePeriod{50};
  /// After this, the picture of a still world is sent again, which detects viewers that have gone.
  static constexpr std::chrono::seconds kRepeat{2};

  PictureStream(boost::asio::ip::tcp::socket socket, WebContext& context, ImageRequest image);

  /// Sends the header and, unless `head_only`, the pictures.
  void Start(bool head_only);
  void Close() override;

 private:
  void Ask();
  void OnPicture(const ImageResult& result);
  void Write();
  void WaitForNews();
  /// Closes the connection when the viewer does.
  void WatchViewer();

  boost::asio::ip::tcp::socket socket_;
  WebContext& context_;
  const ImageRequest image_;
  boost::asio::steady_timer timer_;
  std::string part_;
  std::array<char, 512> ignored_;
  SceneMoment asked_at_;
  bool shown_ = false;  // at least one picture was made
  std::chrono::steady_clock::time_point written_at_;
};

/// A file, read from the disk piece by piece as the client receives it.
class FileStream : public WebConnection, public std::enable_shared_from_this<FileStream> {
 public:
  static constexpr std::size_t kPieceBytes = std::size_t{256} << 10;
  static constexpr std::chrono::seconds kPieceTime{60};

  /// Owns the connection and closes it after the file.
  FileStream(boost::beast::tcp_stream stream, RunFiles& files, UniqueFd file, std::uint64_t bytes);

  /// Sends the header and, unless `head_only`, the file, as `name`.
  void Start(const std::string& name, bool head_only);
  void Close() override;

 private:
  void SendPiece();
  void End();

  boost::beast::tcp_stream stream_;
  RunFiles& files_;
  const std::shared_ptr<const UniqueFd> file_;
  std::uint64_t left_;
  std::string header_;
  std::array<char, 1024> ignored_;
};

}  // namespace coopdyn
