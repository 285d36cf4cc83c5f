// SPDX-License-Identifier: MIT
#include "server/web/run_files.h"

#include <boost/asio/post.hpp>
#include <filesystem>
#include <system_error>

#include "server/base/mutex.h"

namespace coopdyn {

namespace {

void RemoveIfTemporary(const WebRunFile& file) {
  std::error_code ignored;
  if (file.temporary) std::filesystem::remove(file.file, ignored);
}

}  // namespace

/// The way back to the UI thread, for answers that may come when it is gone.
class RunFiles::Mailbox {
 public:
  Mailbox(boost::asio::io_context& context, RunFiles& files) : context_(&context), files_(files) {}

  void Post(std::uint64_t ticket, const WebRunFile& file) EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    if (context_ == nullptr) return RemoveIfTemporary(file);
    boost::asio::post(*context_, [&files = files_, ticket, file] { files.Deliver(ticket, file); });
  }
  void Close() EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    context_ = nullptr;
  }

 private:
  Mutex mutex_;
  boost::asio::io_context* context_ GUARDED_BY(mutex_);
  RunFiles& files_;
};

RunFiles::RunFiles(boost::asio::io_context& context, const WebRuns& runs)
    : runs_(runs), mailbox_(std::make_shared<Mailbox>(context, *this)) {}

RunFiles::~RunFiles() {
  Stop();
}

std::uint64_t RunFiles::Wait(Done done) {
  const std::uint64_t ticket = ++last_ticket_;
  waiting_.emplace(ticket, std::move(done));
  return ticket;
}

void RunFiles::List(Done done) {
  const std::uint64_t ticket = Wait(std::move(done));
  if (!runs_.list) return mailbox_->Post(ticket, {200, "[]", {}, false});
  runs_.list([mailbox = mailbox_, ticket](const std::string& json) {
    mailbox->Post(ticket, {200, json, {}, false});
  });
}

void RunFiles::Open(const std::string& name, Done done) {
  const std::uint64_t ticket = Wait(std::move(done));
  if (!runs_.open) return mailbox_->Post(ticket, {404, "this daemon keeps no recordings", {}, false});
  runs_.open(name, [mailbox = mailbox_, ticket](const WebRunFile& file) { mailbox->Post(ticket, file); });
}

void RunFiles::Deliver(std::uint64_t ticket, const WebRunFile& file) {
  auto found = waiting_.extract(ticket);
  if (!found) return RemoveIfTemporary(file);
  found.mapped()(file);
}

void RunFiles::Stop() {
  mailbox_->Close();
}

}  // namespace coopdyn
