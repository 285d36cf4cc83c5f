// SPDX-License-Identifier: MIT
// One HTTP answer with a file, read from the disk piece by piece as the client takes it. UI thread.
#pragma once

#include <utility>

#include <array>
#include <boost/beast/core/tcp_stream.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "server/net/unique_fd.h"
#include "server/web/web_context.h"

namespace coopdyn {

class FileStream : public WebConnection, public std::enable_shared_from_this<FileStream> {
 public:
  static constexpr std::size_t kPieceBytes = std::size_t{256} << 10;
  static constexpr std::chrono::seconds kPieceTime{60};

  /// Takes the connection, which ends with the file.
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
