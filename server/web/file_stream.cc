// SPDX-License-Identifier: MIT
#include "server/web/file_stream.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <cerrno>

#include "server/naming/run_names.h"
#include "server/web/http_routes.h"

namespace coopdyn {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

/// As RFC 6266 has it.
std::string FileNameParameter(const std::string& name) {
  const std::string coded = PercentEncode(name);
  return coded == name ? "=\"" + name + "\"" : "*=UTF-8''" + coded;
}

}  // namespace

FileStream::FileStream(boost::beast::tcp_stream stream, UniqueFd file, std::uint64_t bytes)
    : stream_(std::move(stream)), file_(std::move(file)), left_(bytes) {}

void FileStream::Start(const std::string& name, bool head_only) {
  header_ = "HTTP/1.1 200 OK\r\nConnection: close\r\nCache-Control: no-store\r\n";
  for (const auto& [key, value] : CommonHeaders()) header_ += key + ": " + value + "\r\n";
  const bool is_run = name.ends_with(".run");
  header_ +=
      std::string("Content-Type: ") + (is_run ? "application/vnd.sqlite3" : "application/octet-stream");
  header_ += "\r\nContent-Disposition: attachment; filename" + FileNameParameter(name);
  header_ += "\r\nContent-Length: " + std::to_string(left_) + "\r\n\r\n";
  if (head_only) left_ = 0;
  posix_fadvise(file_.get(), 0, kPieceBytes, POSIX_FADV_WILLNEED);
  stream_.expires_after(kPieceTime);
  asio::async_write(stream_, asio::buffer(header_),
                    [self = shared_from_this()](error_code failed, std::size_t) {
                      if (failed) return self->Close();
                      self->SendPiece();
                    });
}

void FileStream::SendPiece() {
  if (left_ == 0) return End();
  piece_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kPieceBytes, left_)));
  ssize_t count = 0;
  do {
    count = ::read(file_.get(), piece_.data(), piece_.size());
  } while (count < 0 && errno == EINTR);
  if (count <= 0) return Close();  // it is shorter than it was: the client sees that the length is not right
  left_ -= static_cast<std::uint64_t>(count);
  // The kernel fetches the next piece while this one is sent, so that the UI thread need not wait for the
  // disk.
  posix_fadvise(file_.get(), ::lseek(file_.get(), 0, SEEK_CUR), kPieceBytes, POSIX_FADV_WILLNEED);
  stream_.expires_after(kPieceTime);
  asio::async_write(stream_, asio::buffer(piece_.data(), static_cast<std::size_t>(count)),
                    [self = shared_from_this()](error_code failed, std::size_t) {
                      if (failed) return self->Close();
                      self->SendPiece();
                    });
}

void FileStream::End() {
  error_code ignored;
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  // Until the client has closed too, so that it gets everything.
  piece_.resize(1024);
  stream_.expires_after(kPieceTime);
  stream_.async_read_some(asio::buffer(piece_),
                          [self = shared_from_this()](error_code, std::size_t) { self->Close(); });
}

void FileStream::Close() {
  stream_.close();
}

}  // namespace coopdyn
