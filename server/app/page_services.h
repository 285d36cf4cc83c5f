// SPDX-License-Identifier: MIT
// What the page asks of files, done on threads that give way to the run: texts are checked, uploads kept, the
// gallery drawn. Calls on the UI thread.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "server/app/gallery.h"
#include "server/app/uploads.h"
#include "server/base/log.h"
#include "server/net/io_thread.h"
#include "server/web/web_options.h"

namespace coopdyn {

class PageServices {
 public:
  static constexpr int kMaxWaiting = 8;     // texts to be checked or kept
  static constexpr int kMaxPictures = 256;  // of the gallery that wait

  /// `uploads`: the folder for them, the last of `path`. `images`: null without pictures. All outlive it.
  PageServices(const SearchPath& path, const std::filesystem::path& uploads, ImageBoard* images,
               Logger logger);
  /// Ends after what is being done.
  ~PageServices();
  PageServices(const PageServices&) = delete;
  PageServices& operator=(const PageServices&) = delete;

  /// For the web server, which stops before this ends.
  WebFiles files();

 private:
  void Check(const WebFile& file, const WebFiles::Done& done);
  void Keep(const WebFile& file, const WebFiles::Done& done);

  const SearchPath& path_;
  Uploads uploads_;  // checks_
  Gallery gallery_;  // drawings_
  std::atomic<int> waiting_{0}, pictures_{0};
  // Last: what they run uses the rest.
  IoThread checks_, drawings_;
};

}  // namespace coopdyn
