// SPDX-License-Identifier: MIT
#include "server/web/status_feed.h"

#include <boost/asio/post.hpp>

#include "protocol/command_ids.h"
#include "server/web/module_link.h"

namespace coopdyn {

StatusFeed::StatusFeed(boost::asio::io_context& context, const NameTable& names)
    : context_(context), names_(names), timer_(context) {}

StatusFeed::~StatusFeed() {
  CloseLink();
}

void StatusFeed::Watch(std::weak_ptr<StatusWatcher> watcher) {
  watchers_.push_back(std::move(watcher));
  if (polling_) return;
  polling_ = true;
  Poll();
}

void StatusFeed::Ask(std::function<void(const Message&)> done) {
  if (!link_ || !link_->is_open()) {
    const std::optional<NameEntry> entry = names_.Find("/simulation");
    link_ = entry ? ModuleLink::Open(context_, *entry, {.text = "page status", .trusted = true}) : nullptr;
  }
  if (!link_) {
    boost::asio::post(context_, [done = std::move(done)] {
      done(ErrorReply(command::kGetStatus, Error::kNoSuchName, "there is no module /simulation"));
    });
    return;
  }
  Message request;
  request.command = command::kGetStatus;
  link_->Call(request, [this, alive = std::weak_ptr(alive_), done = std::move(done)](const Message& reply) {
    done(reply);
    if (!alive.expired() && !polling_ && link_ && link_->waiting() == 0) CloseLink();
  });
}

void StatusFeed::CloseLink() {
  if (link_) link_->Close();
  link_ = nullptr;
}

void StatusFeed::Poll() {
  std::erase_if(watchers_, [](const auto& watcher) { return watcher.expired(); });
  if (watchers_.empty()) {
    polling_ = false;
    return CloseLink();
  }
  timer_.expires_after(kPeriod);
  Ask([this, alive = std::weak_ptr(alive_)](const Message& reply) {
    if (alive.expired()) return;
    Broadcast(reply);
    // Polls again when the period ends; at once if the reply took longer.
    timer_.async_wait([this, alive](boost::system::error_code failed) {
      if (!failed && !alive.expired()) Poll();
    });
  });
}

void StatusFeed::Broadcast(const Message& reply) {
  const auto status = std::make_shared<const std::string>(reply.error == 0 ? reply.text : "null");
  const auto watchers = watchers_;
  for (const auto& weak : watchers) {
    if (const auto watcher = weak.lock()) watcher->OnStatus(status);
  }
}

}  // namespace coopdyn
