// SPDX-License-Identifier: MIT
#include "server/app/yars_desk.h"

#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "protocol/command_ids.h"
#include "server/base/printable.h"
#include "server/model/text_file.h"
#include "server/rosiml/translate.h"

namespace coopdyn {

namespace {

constexpr const char* kStopping = "the daemon is stopping";

}  // namespace

void YarsDesk::Open(Endpoint& simulation) {
  simulation_ = &simulation;
  for (auto& [order, done] : std::exchange(early_, {})) Take(order, std::move(done));
}

void YarsDesk::Close() {
  closed_ = true;
  for (auto& [order, done] : std::exchange(early_, {})) Take(order, std::move(done));
  if (simulation_ == nullptr) return;
  Endpoint& simulation = *std::exchange(simulation_, nullptr);
  if (!jobs_.empty()) simulation.OnClosed(*this);
  for (Job& job : std::exchange(jobs_, {})) job.done(ErrorReply(0, Error::kNotPossible, kStopping));
}

std::string YarsDesk::Refusal(const YarsOrder& order, const Connection& asker) const {
  if (order.kind == YarsOrder::Kind::kLog || (order.kind == YarsOrder::Kind::kQuit && !quits_)) return {};
  if (net_.read_only()) return kReadOnlyText;
  if (asker.trusted()) return {};
  return "a client of YARS on another machine may drive its robot, not change the world, as YARS knows no "
         "token: run it on this machine, or reset and load from /simulation after hello NAME TOKEN";
}

void YarsDesk::Ask(YarsOrder order, const Connection& asker, std::function<void(const Message&)> done) {
  if (const std::string refusal = Refusal(order, asker); !refusal.empty()) {
    net_.LogPeer(spdlog::level::warn, asker.peer(), refusal);
    return done(ErrorReply(0, Error::kNotAllowed, refusal));
  }
  if (order.kind == YarsOrder::Kind::kLog)
    net_.LogPeer(spdlog::level::info, asker.peer(), "message: " + Printable(order.text));
  control_.Post([this, order = std::move(order), done = std::move(done)] { Take(order, done); });
}

std::optional<YarsDesk::FileStamp> YarsDesk::StampOf(const std::string& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return std::nullopt;
  const auto ns = [](const timespec& time) { return time.tv_sec * kNanosecondsPerSecond + time.tv_nsec; };
  constexpr std::time_t kCoarse_s = 2;  // some file systems have a resolution of seconds
  if (std::time(nullptr) - status.st_ctim.tv_sec <= kCoarse_s) return std::nullopt;
  return FileStamp{status.st_dev, status.st_ino, status.st_size, ns(status.st_mtim), ns(status.st_ctim)};
}

bool YarsDesk::IsEdited(const std::shared_ptr<const Scenario>& scenario) {
  const std::string& file = scenario->file;
  if (file.empty() || file == kPipe || !rosiml::IsExperiment(scenario->text)) return false;
  const std::optional<FileStamp> stamp = StampOf(file);
  const bool is_same = unedited_ != nullptr && unedited_->file == file &&
                       (unedited_ == scenario || unedited_->text == scenario->text);
  if (is_same && stamp && stamp == stamp_) return false;
  Diagnostics logged_by_reload;
  const std::optional<std::string> text = ReadTextFile(file, {file, 0}, logged_by_reload);
  if (!text || !scenario->text.starts_with(*text)) return true;
  // Settings from the command line may follow the file's text.
  std::string_view rest = std::string_view(scenario->text).substr(text->size());
  rest.remove_prefix(std::min(rest.find_first_not_of('\n'), rest.size()));
  if (!rest.empty() && !rest.starts_with("[SET]\n")) return true;
  unedited_ = scenario;
  stamp_ = stamp;
  return false;
}

void YarsDesk::KeepSeed(Job& job) const {
  const FramePtr now = frames_.Latest();
  if (job.before == nullptr || now->seed == job.before->seed) return;
  const auto own = [](const FramePtr& frame) { return frame->scene->scenario->simulation.own_seed; };
  constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (own(now) == own(job.before) && job.before->seed <= kMost)
    job.requests.front().params = {static_cast<std::int32_t>(job.before->seed)};
}

void YarsDesk::Take(const YarsOrder& order, std::function<void(const Message&)> done) {
  if (closed_) return done(ErrorReply(0, Error::kNotPossible, kStopping));
  if (simulation_ == nullptr) {
    early_.emplace_back(order, std::move(done));
    return;
  }
  Job job{{}, std::move(done)};
  switch (order.kind) {
    case YarsOrder::Kind::kReset:
      if (const FramePtr frame = frames_.Latest(); frame && IsEdited(frame->scene->scenario)) {
        job.requests.push_back(ReplyTo(command::kReload));
        if (!order.seed) job.before = frame;
      }
      job.requests.push_back(ReplyTo(command::kReset));
      if (order.seed) job.requests.back().params = {static_cast<std::int32_t>(*order.seed & 0x7fffffff)};
      break;
    case YarsOrder::Kind::kLoadText:
    case YarsOrder::Kind::kLoadFile:
      job.requests.push_back(ReplyTo(command::kLoadScenario, order.text));
      break;
    case YarsOrder::Kind::kLog:
      break;
    case YarsOrder::Kind::kQuit:
      if (quits_) job.requests.push_back(ReplyTo(command::kQuit));
      break;
  }
  if (job.requests.empty()) return job.done(ReplyTo(0));
  jobs_.push_back(std::move(job));
  if (jobs_.size() > 1) return;
  // The desk is a client only while it has requests.
  id_ = net_.NextClient();
  simulation_->OnOpen(*this);
  Begin();
}

void YarsDesk::Begin() {
  Message request = std::move(jobs_.front().requests.front());
  jobs_.front().requests.pop_front();
  // Post the reply, so that an immediate reply does not arrive within the call.
  simulation_->OnRequest(*this, std::move(request),
                         [this](const Message& reply) { control_.Post([this, reply] { OnReply(reply); }); });
}

void YarsDesk::OnReply(const Message& reply) {
  if (jobs_.empty()) return;
  // If a reload fails, log the errors and continue: the world is unchanged.
  const bool was_reload = reply.command == command::kReload;
  if (was_reload && reply.error == 0) KeepSeed(jobs_.front());
  if (reply.error != 0) net_.logger()->warn("asked by a client of YARS: {}", reply.text);
  if ((reply.error == 0 || was_reload) && !jobs_.front().requests.empty()) return Begin();
  const std::function<void(const Message&)> done = std::move(jobs_.front().done);
  jobs_.pop_front();
  if (jobs_.empty() && simulation_ != nullptr) simulation_->OnClosed(*this);
  done(reply);
  if (!jobs_.empty()) Begin();
}

}  // namespace coopdyn
