// SPDX-License-Identifier: MIT
#include "server/web/streams.h"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

#include "server/naming/run_names.h"
#include "server/web/http_routes.h"

namespace coopdyn {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr std::string_view kBoundary = "coopdyn-picture";

}  // namespace

PictureStream::PictureStream(asio::ip::tcp::socket socket, WebContext& context, ImageRequest image)
    : socket_(std::move(socket)), context_(context), image_(std::move(image)), timer_(context.io) {}

void PictureStream::Start(bool head_only) {
  part_ = StreamHeader("Content-Type: multipart/x-mixed-replace; boundary=" + std::string(kBoundary));
  if (!head_only) part_ += "--" + std::string(kBoundary) + "\r\n";
  asio::async_write(socket_, asio::buffer(part_),
                    [self = shared_from_this(), head_only](error_code failed, std::size_t) {
                      if (failed || head_only) return self->Close();
                      self->WatchViewer();
                      self->Ask();
                    });
}

void PictureStream::Close() {
  timer_.cancel();
  error_code ignored;
  socket_.shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
  socket_.close(ignored);
}

void PictureStream::Ask() {
  asked_at_ = context_.pictures.moment();
  ImageRequest image = image_;
  image.paced = shown_;
  context_.pictures.Request(
      std::move(image), [self = shared_from_this()](const ImageResult& result) { self->OnPicture(result); });
}

void PictureStream::OnPicture(const ImageResult& result) {
  if (!socket_.is_open()) return;
  if (!result.error.empty()) {
    // The request was dropped in favour of others. A viewer without any picture has nothing to keep showing.
    return shown_ ? WaitForNews() : Close();
  }
  shown_ = true;
  // The boundary after the picture makes browsers show it at once.
  part_ = "Content-Type: image/jpeg\r\nContent-Length: " + std::to_string(result.bytes->size()) + "\r\n\r\n";
  part_.append(result.bytes->begin(), result.bytes->end());
  part_ += "\r\n--" + std::string(kBoundary) + "\r\n";
  Write();
}

void PictureStream::Write() {
  timer_.expires_after(kWriteTime);
  timer_.async_wait([self = shared_from_this()](error_code cancelled) {
    if (!cancelled) self->Close();
  });
  asio::async_write(socket_, asio::buffer(part_),
                    [self = shared_from_this()](error_code failed, std::size_t) {
                      self->timer_.cancel();
                      if (failed) return self->Close();
                      self->written_at_ = std::chrono::steady_clock::now();
                      if (self->context_.pictures.moment() == self->asked_at_) return self->WaitForNews();
                      self->Ask();
                    });
}

void PictureStream::WaitForNews() {
  timer_.expires_after(kIdlePeriod);
  timer_.async_wait([self = shared_from_this()](error_code cancelled) {
    if (cancelled || !self->socket_.is_open()) return;
    if (self->context_.pictures.moment() != self->asked_at_) return self->Ask();
    if (std::chrono::steady_clock::now() - self->written_at_ > kRepeat) return self->Write();
    self->WaitForNews();
  });
}

void PictureStream::WatchViewer() {
  socket_.async_read_some(asio::buffer(ignored_),
                          [self = shared_from_this()](error_code failed, std::size_t) {
                            if (failed) return self->Close();
                            self->WatchViewer();
                          });
}

namespace {

/// The end of Content-Disposition's `filename` parameter, per RFC 6266.
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
    if (piece->empty()) return self->Close();  // the file has shrunk: the client sees the wrong length
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
  // Wait until the client closes too, so that it receives everything.
  stream_.expires_after(kPieceTime);
  stream_.async_read_some(asio::buffer(ignored_),
                          [self = shared_from_this()](error_code, std::size_t) { self->Close(); });
}

void FileStream::Close() {
  stream_.close();
}

}  // namespace coopdyn
