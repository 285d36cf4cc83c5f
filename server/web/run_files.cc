// SPDX-License-Identifier: MIT
#include "server/web/run_files.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace coopdyn {

namespace {

void RemoveIfTemporary(const WebRunFile& file) {
  std::error_code ignored;
  if (file.temporary) std::filesystem::remove(file.file, ignored);
}

}  // namespace

RunFiles::RunFiles(boost::asio::io_context& context, const WebRuns& runs, Logger logger)
    : runs_(runs), logger_(std::move(logger)), answers_(context, RemoveIfTemporary), pieces_(context) {}

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

void RunFiles::Read(std::shared_ptr<const UniqueFd> file, std::size_t bytes,
                    std::function<void(const Piece&)> done) {
  if (!disk_) disk_.emplace("web disk", logger_);
  disk_->Post([file = std::move(file), bytes, answer = pieces_.Expect(std::move(done))] {
    auto piece = std::make_shared<std::string>(bytes, '\0');
    ssize_t count;
    do {
      count = ::read(file->get(), piece->data(), bytes);
    } while (count < 0 && errno == EINTR);
    piece->resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    answer(piece);
  });
}

}  // namespace coopdyn
