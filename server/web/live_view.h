// SPDX-License-Identifier: MIT
// The stream of pictures for one viewer. A picture is asked for only when the viewer has shown an earlier
// one, and when there is something new to see; a moved camera is answered at once. UI thread.
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
  /// Pictures sent and not yet shown: one is on its way while another is being drawn.
  static constexpr int kMaxUnshown = 2;
  /// How often a world that stands still is checked for a change.
  static constexpr std::chrono::milliseconds kIdlePeriod{50};

  /// `on_picture` gets every picture, also one that could not be made. `pictures` outlives the view.
  LiveView(boost::asio::io_context& context, Pictures& pictures,
           std::function<void(const ImageResult&)> on_picture);
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  /// Pictures like `request` from now on; nothing: no more.
  void Set(std::optional<ImageRequest> request);
  /// The viewer has shown a picture.
  void Shown();

 private:
  void Next();
  void Ask(bool paced);
  void WaitForNews();

  Pictures& pictures_;
  std::function<void(const ImageResult&)> on_picture_;
  boost::asio::steady_timer timer_;
  std::optional<ImageRequest> request_;
  bool moved_ = false;            // the camera has, since the last request
  std::uint64_t generation_ = 0;  // of the request whose picture is awaited
  bool waiting_ = false;          // for that picture
  bool waiting_paced_ = false;
  bool idle_ = false;  // the timer runs
  int unshown_ = 0;
  SceneMoment asked_at_;
  std::shared_ptr<char> alive_ = std::make_shared<char>();  // expires with the view
};

}  // namespace coopdyn
