// SPDX-License-Identifier: MIT
#include "server/web/picture_stream.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

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
    // It gave way to others; a viewer without any picture yet has nothing to look at.
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

}  // namespace coopdyn
