// SPDX-License-Identifier: MIT
// Texts and pictures of files for the UI thread, which waits for no disk: checks, uploads, the gallery.
#pragma once

#include <utility>

#include <boost/asio/io_context.hpp>
#include <string>
#include <string_view>

#include "server/web/answers.h"
#include "server/web/web_options.h"

namespace coopdyn {

/// {"name":"my.scenario","text":"[ROBOT_1]…","token":"T"}: the body of /api/check and /api/upload.
struct PageFileRead {
  WebFile file;
  std::string token;
  std::string error;  // says what to write instead
};
PageFileRead ReadPageFile(std::string_view json);

class PageFiles {
 public:
  using Done = WebFiles::Done;

  /// Both outlive it.
  PageFiles(boost::asio::io_context& context, const WebFiles& files) : files_(files), answers_(context) {}

  /// `done` is called once on the UI thread, later, unless Stop() came first. UI thread.
  void Check(WebFile file, Done done);
  void Upload(WebFile file, Done done);
  void Gallery(Done done);
  /// `kind`: world, scenario or robot.
  void Thumb(const std::string& kind, const std::string& name, Done done);
  /// Of a world or a scenario.
  void Text(const std::string& kind, const std::string& name, Done done);
  /// What is asked of a recording besides its file.
  void Run(const RunView& view, Done done);
  /// No answer gets through any more, those that wait are forgotten. UI thread, or when that has stopped.
  void Stop() { answers_.Stop(); }

 private:
  const WebFiles& files_;
  Answers<HttpAnswer> answers_;
};

}  // namespace coopdyn
