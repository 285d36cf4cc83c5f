// SPDX-License-Identifier: MIT
#include "server/web/live_view.h"

#include <algorithm>

namespace coopdyn {

LiveView::LiveView(boost::asio::io_context& context, Pictures& pictures,
                   std::function<void(const ImageResult&)> on_picture)
    : pictures_(pictures), on_picture_(std::move(on_picture)), timer_(context) {}

void LiveView::Set(std::optional<ImageRequest> request) {
  if (request == request_) return;
  if (!request || !request_) unshown_ = 0;
  request_ = std::move(request);
  moved_ = request_.has_value();
  Next();
}

void LiveView::Shown() {
  unshown_ = std::max(0, unshown_ - 1);
  Next();
}

void LiveView::Next() {
  if (!request_ || unshown_ >= kMaxUnshown) return;
  if (moved_) {
    // Replace a paced request of the old camera, which may still be queued. Wait for an unpaced one.
    if (!waiting_ || waiting_paced_) Ask(false);
  } else if (!waiting_ && unshown_ == 0) {
    if (pictures_.moment() == asked_at_) {
      WaitForNews();
    } else {
      Ask(true);
    }
  }
}

void LiveView::Ask(bool paced) {
  moved_ = false;
  waiting_ = true;
  waiting_paced_ = paced;
  asked_at_ = pictures_.moment();
  ImageRequest request = *request_;
  request.paced = paced;
  const std::uint64_t generation = ++generation_;
  pictures_.Request(std::move(request),
                    [this, alive = std::weak_ptr(alive_), generation](const ImageResult& result) {
                      if (alive.expired() || generation != generation_) return;
                      waiting_ = false;
                      if (!request_) return;
                      if (!result.error.empty() && waiting_paced_) {
                        moved_ = true;  // dropped in favour of other requests: retry a little later
                        return WaitForNews();
                      }
                      ++unshown_;
                      on_picture_(result);
                      Next();
                    });
}

void LiveView::WaitForNews() {
  if (idle_) return;
  idle_ = true;
  timer_.expires_after(kIdlePeriod);
  timer_.async_wait([this, alive = std::weak_ptr(alive_)](boost::system::error_code failed) {
    if (failed || alive.expired()) return;
    idle_ = false;
    Next();
  });
}

}  // namespace coopdyn
