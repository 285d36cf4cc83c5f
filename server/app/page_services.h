// SPDX-License-Identifier: MIT
// What the page asks of files, done on threads that give way to the run: texts are checked, uploads kept, the
// gallery drawn, recordings looked into. Calls on the UI thread.
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
  static constexpr int kMaxWaiting = 8;     // texts to be checked or kept
  static constexpr int kMaxPictures = 256;  // of the gallery that wait

  static constexpr int kMaxViews = 8;  // of recordings that wait

  /// `uploads`: the folder for them, the last of `path`. `images`: null without pictures. `run` knows what is
  /// played. All outlive it.
  PageServices(const SearchPath& path, const std::filesystem::path& uploads, ImageBoard* images,
               RunFolder& runs, const RunControl& run, const ReplayServices& replay, Logger logger);
  /// Ends what is being done, or waits for it. `runs` has stopped.
  ~PageServices();
  PageServices(const PageServices&) = delete;
  PageServices& operator=(const PageServices&) = delete;

  /// For the web server, which stops before this ends.
  WebFiles files();

 private:
  void Check(const WebFile& file, const WebFiles::Done& done);
  void Keep(const WebFile& file, const WebFiles::Done& done);
  /// On views_: what is asked of the recording in `file`, and for a parting of that in `other`.
  HttpAnswer View(const RunView& view, const std::string& file, const std::string& other);

  const SearchPath& path_;
  Uploads uploads_;  // checks_
  Gallery gallery_;  // drawings_; its texts: checks_
  RunFolder& runs_;
  const RunControl& run_;
  WorkerPool pool_{1};  // of views_: the daemon's own is the stepping thread's
  const ReplayServices replay_;
  std::atomic<int> waiting_{0}, pictures_{0}, viewing_{0};
  std::stop_source stopping_;
  // Last: what they run uses the rest.
  IoThread checks_, drawings_, views_;
};

}  // namespace coopdyn
