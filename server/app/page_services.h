// SPDX-License-Identifier: MIT
// Handles the page's file requests on low-priority threads: checks texts, keeps uploads, draws the gallery,
// reads recordings. Called on the UI thread.
#pragma once

#include <atomic>
#include <filesystem>
#include <stop_token>
#include <string>

#include "server/app/gallery.h"
#include "server/app/uploads.h"
#include "server/base/log.h"
#include "server/base/worker_pool.h"
#include "server/control/run_folder.h"
#include "server/net/io_thread.h"
#include "server/replay/state_at.h"
#include "server/web/web_options.h"

namespace coopdyn {

class PageServices {
 public:
  static constexpr int kMaxWaiting = 8;     // queued texts to check or keep
  static constexpr int kMaxPictures = 256;  // queued pictures of the gallery

  static constexpr int kMaxViews = 8;  // queued views of recordings

  /// `uploads`: the upload folder, the last of `path`. `images`: null without pictures. `run` knows the
  /// recording being played. All must outlive it.
  PageServices(const SearchPath& path, const std::filesystem::path& uploads, ImageBoard* images,
               RunFolder& runs, const RunControl& run, const ReplayServices& replay, Logger logger);
  /// Stops or finishes the current work. @pre `runs` has stopped
  ~PageServices();
  PageServices(const PageServices&) = delete;
  PageServices& operator=(const PageServices&) = delete;

  /// The handlers for the web server, which must stop before this is destroyed.
  WebFiles files();

 private:
  void Check(const WebFile& file, const WebFiles::Done& done);
  void Keep(const WebFile& file, const WebFiles::Done& done);
  /// Answers `view` of the recording in `file`; `other`: the second recording, for a parting. Runs on views_.
  HttpAnswer View(const RunView& view, const std::string& file, const std::string& other);

  const SearchPath& path_;
  Uploads uploads_;  // used on checks_
  Gallery gallery_;  // used on drawings_; TextOf() on checks_
  RunFolder& runs_;
  const RunControl& run_;
  WorkerPool pool_{1};  // for views_: the daemon's pool belongs to the stepping thread
  const ReplayServices replay_;
  std::atomic<int> waiting_{0}, pictures_{0}, viewing_{0};
  std::stop_source stopping_;
  // Last: their tasks use the other members.
  IoThread checks_, drawings_, views_;
};

}  // namespace coopdyn
