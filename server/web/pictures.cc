// SPDX-License-Identifier: MIT
#include "server/web/pictures.h"

#include <boost/asio/post.hpp>

#include "server/base/mutex.h"

namespace coopdyn {

/// The way back to the UI thread, for answers that may come when it is gone.
class Pictures::Mailbox {
 public:
  Mailbox(boost::asio::io_context& context, Pictures& pictures) : context_(&context), pictures_(pictures) {}

  void Post(std::uint64_t ticket, const ImageResult& result) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    if (context_ == nullptr) return;
    boost::asio::post(*context_,
                      [&pictures = pictures_, ticket, result] { pictures.Deliver(ticket, result); });
  }
  void Close() EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    context_ = nullptr;
  }

 private:
  Mutex mutex_;
  boost::asio::io_context* context_ GUARDED_BY(mutex_);
  Pictures& pictures_;
};

Pictures::Pictures(boost::asio::io_context& context, const FrameBoard& frames, ImageBoard* images)
    : frames_(frames), images_(images), mailbox_(std::make_shared<Mailbox>(context, *this)) {}

Pictures::~Pictures() {
  Stop();
}

void Pictures::Request(ImageRequest request, std::function<void(const ImageResult&)> done) {
  const std::uint64_t ticket = ++last_ticket_;
  waiting_.emplace(ticket, std::move(done));
  if (images_ == nullptr) {
    ImageResult none;
    none.error = "the daemon runs without pictures (--no-render)";
    mailbox_->Post(ticket, none);
    return;
  }
  images_->Request(std::move(request), [mailbox = mailbox_, ticket](const ImageResult& result) {
    mailbox->Post(ticket, result);
  });
}

void Pictures::Deliver(std::uint64_t ticket, const ImageResult& result) {
  auto found = waiting_.extract(ticket);
  if (found) found.mapped()(result);
}

SceneMoment Pictures::moment() const {
  const FramePtr frame = frames_.Latest();
  if (!frame) return {};
  return {frame->epoch, frame->step, frame->revision};
}

void Pictures::Stop() {
  mailbox_->Close();
}

}  // namespace coopdyn
