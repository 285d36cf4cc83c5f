// SPDX-License-Identifier: MIT
#include "server/web/run_files.h"

#include <filesystem>
#include <system_error>

namespace coopdyn {

namespace {

void RemoveIfTemporary(const WebRunFile& file) {
  std::error_code ignored;
  if (file.temporary) std::filesystem::remove(file.file, ignored);
}

}  // namespace

RunFiles::RunFiles(boost::asio::io_context& context, const WebRuns& runs)
    : runs_(runs), answers_(context, RemoveIfTemporary) {}

void RunFiles::List(Done done) {
  const Done answer = answers_.Expect(std::move(done));
  if (!runs_.list) return answer({200, "[]", {}, false});
  runs_.list([answer](const std::string& json) { answer({200, json, {}, false}); });
}

void RunFiles::Open(const std::string& name, Done done) {
  const Done answer = answers_.Expect(std::move(done));
  if (!runs_.open) return answer({404, "this daemon keeps no recordings", {}, false});
  runs_.open(name, answer);
}

}  // namespace coopdyn
