// SPDX-License-Identifier: MIT
// The stream of pictures for one viewer. Requests a picture only when the viewer has shown the earlier ones
// and the world has changed, but at once when the camera moves. UI thread.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "server/web/pictures.h"

namespace coopdyn {

class LiveView {
 public:
  /// Pictures sent but not yet shown: one in transit while the viewer draws another.
  static constexpr int kMaxUnshown = 2;
  /// How often a still world is checked for a change.
  static constexpr std::chrono::milliseconds kIdlePeriod{50};

  /// Calls `on_picture` with every picture, and with errors of unpaced requests; retries paced ones.
  /// `pictures` outlives the view.
  LiveView(boost::asio::io_context& context, Pictures& pictures,
           std::function<void(const ImageResult&)> on_picture);
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  /// Sends pictures as in `request` from now on; nullopt stops them.
  void Set(std::optional<ImageRequest> request);
  /// Reports that the viewer has shown a picture.
  void Shown();

 private:
  void Next();
  void Ask(bool paced);
  void WaitForNews();

  Pictures& pictures_;
  std::function<void(const ImageResult&)> on_picture_;
  boost::asio::steady_timer timer_;
  std::optional<ImageRequest> request_;
  bool moved_ = false;            // the camera moved since the last request, or that request failed
  std::uint64_t generation_ = 0;  // of the last request
  bool waiting_ = false;          // for its picture
  bool waiting_paced_ = false;
  bool idle_ = false;  // the timer runs
  int unshown_ = 0;
  SceneMoment asked_at_;
  std::shared_ptr<char> alive_ = std::make_shared<char>();  // expires with the view
};

}  // namespace coopdyn
