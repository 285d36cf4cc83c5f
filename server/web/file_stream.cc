// SPDX-License-Identifier: MIT
#include "server/web/file_stream.h"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

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

FileStream::FileStream(boost::beast::tcp_stream stream, RunFiles& files, UniqueFd file, std::uint64_t bytes)
    : stream_(std::move(stream)),
      files_(files),
      file_(std::make_shared<const UniqueFd>(std::move(file))),
      left_(bytes) {}

void FileStream::Start(const std::string& name, bool head_only) {
  const char* type = name.ends_with(".run") ? "application/vnd.sqlite3" : "application/octet-stream";
  header_ =
      StreamHeader(std::string("Content-Type: ") + type + "\r\nContent-Disposition: attachment; filename" +
                   FileNameParameter(name) + "\r\nContent-Length: " + std::to_string(left_));
  if (head_only) left_ = 0;
  stream_.expires_after(kPieceTime);
  asio::async_write(stream_, asio::buffer(header_),
                    [self = shared_from_this()](error_code failed, std::size_t) {
                      if (failed) return self->Close();
                      self->SendPiece();
                    });
}

void FileStream::SendPiece() {
  if (left_ == 0) return End();
  const auto bytes = static_cast<std::size_t>(std::min<std::uint64_t>(kPieceBytes, left_));
  files_.Read(file_, bytes, [self = shared_from_this()](const RunFiles::Piece& piece) {
    if (piece->empty()) return self->Close();  // it is shorter than it was: the client sees the wrong length
    self->left_ -= piece->size();
    self->stream_.expires_after(kPieceTime);
    asio::async_write(self->stream_, asio::buffer(*piece), [self, piece](error_code failed, std::size_t) {
      if (failed) return self->Close();
      self->SendPiece();
    });
  });
}

void FileStream::End() {
  error_code ignored;
  stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  // Until the client has closed too, so that it gets everything.
  stream_.expires_after(kPieceTime);
  stream_.async_read_some(asio::buffer(ignored_),
                          [self = shared_from_this()](error_code, std::size_t) { self->Close(); });
}

void FileStream::Close() {
  stream_.close();
}

}  // namespace coopdyn
