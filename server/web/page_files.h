// SPDX-License-Identifier: MIT
// Scenario, world and robot files for the UI thread, which never waits for the disk: checks, uploads, texts,
// the gallery.
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
  std::string error;  // with what to write instead; empty on success
};
PageFileRead ReadPageFile(std::string_view json);

class PageFiles {
 public:
  using Done = WebFiles::Done;

  /// Both outlive this object.
  PageFiles(boost::asio::io_context& context, const WebFiles& files) : files_(files), answers_(context) {}

  /// All requests call `done` once, later, on the UI thread, unless Stop() comes first. UI thread.
  void Check(WebFile file, Done done);
  void Upload(WebFile file, Done done);
  void Gallery(Done done);
  /// `kind`: world, scenario or robot.
  void Thumb(const std::string& kind, const std::string& name, Done done);
  /// The text of a world or scenario.
  void Text(const std::string& kind, const std::string& name, Done done);
  /// A view of a recording.
  void Run(const RunView& view, Done done);
  /// Drops all further answers. UI thread, or after that thread has stopped.
  void Stop() { answers_.Stop(); }

 private:
  const WebFiles& files_;
  Answers<HttpAnswer> answers_;
};

}  // namespace coopdyn
