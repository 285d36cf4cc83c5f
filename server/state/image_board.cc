// SPDX-License-Identifier: MIT
#include "server/state/image_board.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <future>
#include <utility>

namespace coopdyn {

namespace {

constexpr double kMaxDistance_m = 1e5;

bool IsNear(const std::optional<Vector3>& point) {
  return !point || (point->allFinite() && point->cwiseAbs().maxCoeff() <= kMaxDistance_m);
}

void Refuse(const ImageDone& done, const std::string& reason) {
  ImageResult result;
  result.error = reason;
  done(result);
}

}  // namespace

const char* MediaType(ImageFormat format) {
  constexpr std::array kTypes{"image/png", "image/jpeg", "application/octet-stream",
                              "application/octet-stream", "application/octet-stream"};
  return kTypes[static_cast<std::size_t>(format)];
}

std::string CheckImageRequest(const ImageRequest& request) {
  if (request.shot) return {};
  if (request.format == ImageFormat::kDepth || request.format == ImageFormat::kSegmentation)
    return "only cameras of robots see depth and segmentation: name a camera";
  const auto text = [](int pixels) { return std::to_string(pixels); };
  if (request.width < kMinImagePixels || request.width > kMaxImageWidth) {
    return "the width " + text(request.width) + " is not possible: write " + text(kMinImagePixels) + " to " +
           text(kMaxImageWidth) + " pixels";
  }
  if (request.height < kMinImagePixels || request.height > kMaxImageHeight) {
    return "the height " + text(request.height) + " is not possible: write " + text(kMinImagePixels) +
           " to " + text(kMaxImageHeight) + " pixels";
  }
  if (!IsNear(request.eye_m))
    return "eye is not within 100 km of the origin: write three finite numbers in metres";
  if (!IsNear(request.look_m))
    return "look is not within 100 km of the origin: write three finite numbers in metres";
  if (request.eye_m && request.look_m && (*request.eye_m - *request.look_m).norm() < 1e-6) {
    return "eye and look are the same point: write two different ones";
  }
  if (!(request.fov_rad >= 0.05 && request.fov_rad <= 2.5)) {
    return "the field of view must be from 0.05 to 2.5 rad";
  }
  return {};
}

void ImageBoard::Request(ImageRequest request, ImageDone done) {
  std::string reason = CheckImageRequest(request);
  if (!reason.empty()) {
    Refuse(done, reason);
    return;
  }
  Pending refused{std::move(request), std::move(done)};
  {
    MutexLock lock(mutex_);
    if (closed_) {
      reason = close_reason_;
    } else if (waiting_.size() < kMaxWaiting) {
      waiting_.push_back(std::exchange(refused, {}));
    } else {
      reason = "too many pictures are asked for at once: ask again";
      const auto oldest =
          std::find_if(waiting_.begin(), waiting_.end(), [](const Pending& p) { return p.request.paced; });
      if (oldest != waiting_.end()) {
        Pending given_way = std::move(*oldest);
        waiting_.erase(oldest);
        waiting_.push_back(std::exchange(refused, std::move(given_way)));
      }
    }
    arrived_.NotifyAll();
  }
  if (refused.done) Refuse(refused.done, reason);
}

ImageResult ImageBoard::Draw(ImageRequest request) {
  std::promise<ImageResult> drawn;
  Request(std::move(request), [&drawn](const ImageResult& result) { drawn.set_value(result); });
  return drawn.get_future().get();
}

std::vector<ImageBoard::Pending> ImageBoard::WaitAndTake(std::stop_token stop, const Clock& clock,
                                                         Nanoseconds paced_from) {
  std::stop_callback wake(stop, [this] {
    MutexLock lock(mutex_);  // without the lock, the wake-up could fall between the test below and the wait
    arrived_.NotifyAll();
  });
  std::vector<Pending> taken;
  MutexLock lock(mutex_);
  while (!stop.stop_requested() && !closed_) {
    const Nanoseconds early = paced_from - clock.Now();
    TakeReady(early <= 0, taken);
    if (!taken.empty()) break;
    if (waiting_.empty()) {
      arrived_.Wait(mutex_);
    } else {
      arrived_.WaitUntil(mutex_, std::chrono::steady_clock::now() + std::chrono::nanoseconds(early));
    }
  }
  return taken;
}

void ImageBoard::TakeReady(bool paced_too, std::vector<Pending>& taken) {
  std::deque<Pending> later;
  for (Pending& pending : waiting_) {
    if (pending.request.paced && !paced_too) {
      later.push_back(std::move(pending));
    } else {
      taken.push_back(std::move(pending));
    }
  }
  waiting_ = std::move(later);
}

void ImageBoard::Close(const std::string& reason) {
  std::deque<Pending> refused;
  {
    MutexLock lock(mutex_);
    closed_ = true;
    close_reason_ = reason;
    refused.swap(waiting_);
    arrived_.NotifyAll();
  }
  for (const Pending& pending : refused) Refuse(pending.done, reason);
}

}  // namespace coopdyn
