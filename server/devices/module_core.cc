// SPDX-License-Identifier: MIT
#include "server/devices/module_core.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "protocol/codec.h"

namespace coopdyn {

namespace {

constexpr std::size_t kMaxClientName = 200;

std::string Join(std::span<const std::string> words) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += ' ';
    text += word;
  }
  return text;
}

}  // namespace

std::vector<std::string> Words(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  std::vector<std::string> words;
  while (true) {
    const std::size_t start = text.find_first_not_of(kBlanks);
    if (start == std::string_view::npos) return words;
    text.remove_prefix(start);
    const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
    words.emplace_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

void ModuleCore::Stamp(Message& reply, const Frame& frame) {
  reply.data.push_back(frame.time_s());
  reply.data.push_back(static_cast<double>(frame.step));
}

std::optional<Message> ModuleCore::Refuse(const Message& request) const {
  if (request.error != 0) {
    return ErrorReply(request.command, Error::kMalformed, "the error of a request must be 0");
  }
  const CommandSpec* spec = table_.Find(request.command);
  if (spec == nullptr) {
    return ErrorReply(request.command, Error::kUnknownCommand,
                      fmt::format("{} has no command {}: describe (1) lists what it has", table_.module(),
                                  request.command));
  }
  CheckResult checked = CheckRequest(*spec, request.text, request.params, request.data);
  if (checked.error == 0) return std::nullopt;
  return ErrorReply(request.command, static_cast<Error>(checked.error), std::move(checked.text));
}

Message ModuleCore::NotAllowed(const Message& request) {
  return ErrorReply(request.command, Error::kNotAllowed,
                    "not allowed without the token, which the daemon printed at its start: write "
                    "connect(..., token=\"TOKEN\") in Python, connect(..., 'token', 'TOKEN') in MATLAB, "
                    "connect(..., {.token = \"TOKEN\"}) in C++, or send hello NAME TOKEN first");
}

bool ModuleCore::OnlyReads(const CommandSpec& spec) {
  return spec.name.starts_with("get_") || spec.id == command::kPing || spec.id == command::kDescribe ||
         spec.id == command::kReadAll || spec.id == command::kListRuns || spec.id == command::kListWorld ||
         spec.id == command::kSaveWorld || spec.id == command::kPick;
}

std::optional<Message> ModuleCore::AnswerCommon(ModuleClient& client, const Message& request,
                                                const Frame& frame, Mode mode) {
  Message reply;
  switch (request.command) {
    case command::kPing:
      reply = ReplyTo(request.command);
      reply.params = request.params;
      reply.data = request.data;
      break;
    case command::kDescribe:
      reply = ReplyTo(request.command);
      reply.text = table_.DescribeJson(version_);
      break;
    case command::kGetTime:
      return StepReply(client, request.command, {}, frame, mode);
    case command::kSubscribe:
      reply = Subscribe(client, request);
      break;
    case command::kUnsubscribe:
      reply = Unsubscribe(client, request);
      break;
    case command::kAttach:
      reply = Attach(client, request);
      break;
    default:
      return std::nullopt;
  }
  if (reply.error == 0) Stamp(reply, frame);
  return reply;
}

Message ModuleCore::Subscribe(ModuleClient& client, const Message& request) const {
  const std::int32_t every = request.params.empty() ? 1 : request.params[0];
  const command::Id reading = request.params.size() > 1 ? request.params[1] : source_.first_reading();
  std::erase_if(client.subscriptions, [reading](const auto& old) { return old.reading == reading; });
  client.subscriptions.push_back({reading, every, every, 0});
  return ReplyTo(request.command);
}

Message ModuleCore::Unsubscribe(ModuleClient& client, const Message& request) const {
  if (request.params.empty()) {
    client.subscriptions.clear();
  } else {
    std::erase_if(client.subscriptions, [&](const auto& old) { return old.reading == request.params[0]; });
  }
  return ReplyTo(request.command);
}

Message ModuleCore::Attach(ModuleClient& client, const Message& request) const {
  const std::span<const std::string> names = source_.attachable();
  std::vector<std::size_t> attached;
  for (const std::string& word : Words(request.text)) {
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) {
      const std::string instead = names.empty() ? "only the modules of robots take attach"
                                                : "the modules of this robot are " + Join(names);
      return ErrorReply(request.command, Error::kNoSuchName,
                        "there is no module " + word + " to attach: " + instead);
    }
    const auto index = static_cast<std::size_t>(found - names.begin());
    if (std::find(attached.begin(), attached.end(), index) != attached.end()) {
      return ErrorReply(request.command, Error::kWrongParams,
                        word + " is named twice: name each module once");
    }
    attached.push_back(index);
  }
  client.attached = std::move(attached);
  return ReplyTo(request.command);
}

std::optional<Message> ModuleCore::TakeHello(ModuleClient& client, const Message& request,
                                             Nanoseconds now) const {
  std::vector<std::string> words = Words(request.text);
  if (words.empty() || words.size() > 2 || words[0].size() > kMaxClientName) {
    return ErrorReply(
        request.command, Error::kWrongParams,
        fmt::format("hello takes a name without blanks of at most {} bytes, then the token if one is "
                    "needed: hello ana, hello ana TOKEN",
                    kMaxClientName));
  }
  const bool says = words.size() == 2;
  // Local clients need no token, so a wrong one does not count as an attempt.
  if (client.trusted || !says) {
    client.has_token |= says && guard_.Matches(words[1]);
    client.client.name = std::move(words[0]);
    return std::nullopt;
  }
  const TokenVerdict verdict = guard_.Judge(words[1], client.client.peer, now);
  if (verdict == TokenVerdict::kTooSoon) {
    return ErrorReply(request.command, Error::kNotAllowed, guard_.WaitText(client.client.peer, now));
  }
  if (verdict == TokenVerdict::kWrong) {
    return ErrorReply(request.command, Error::kNotAllowed,
                      "wrong token: it is what the daemon printed at its start, or its --token");
  }
  client.has_token = true;
  client.client.name = std::move(words[0]);
  return std::nullopt;
}

Message ModuleCore::StepReply(const ModuleClient& client, command::Id command, std::string text,
                              const Frame& frame, Mode mode) {
  Message reply = ReplyTo(command, std::move(text));
  reply.params.reserve(1 + client.attached.size());
  reply.params.push_back(static_cast<std::int32_t>(mode));
  reply.data.reserve(client.attached.empty() ? 2 : 32);
  for (const std::size_t attachable : client.attached) {
    const std::size_t before = reply.data.size();
    source_.AppendReading(attachable, frame, reply.data);
    reply.params.push_back(static_cast<std::int32_t>(reply.data.size() - before));
  }
  Stamp(reply, frame);
  return reply;
}

bool ModuleCore::PushDue(Connection& connection, ModuleClient& client, const FramePtr& frame, int dropped) {
  if (!source_.reads_alike()) ForgetReadings();
  bool taken = true;
  for (ModuleClient::Subscription& subscription : client.subscriptions) {
    for (int i = 0; i < dropped; ++i) {
      if (--subscription.left > 0) continue;
      subscription.left = subscription.every;
      ++subscription.missed;
    }
    if (--subscription.left > 0) continue;
    subscription.left = subscription.every;
    const auto missed = static_cast<std::int64_t>(std::exchange(subscription.missed, 0));
    taken &= connection.Push(ReadingOf(subscription.reading, frame), missed);
  }
  return taken;
}

void ModuleCore::PushAgain(Connection& connection, const ModuleClient& client, command::Id reading,
                           const FramePtr& frame) {
  for (const auto& subscription : client.subscriptions) {
    if (subscription.reading == reading) connection.Push(ReadingOf(reading, frame), 0);
  }
}

const UnaskedPtr& ModuleCore::ReadingOf(command::Id reading, const FramePtr& frame) {
  for (const auto& [of, message] : readings_) {
    if (of == reading) return message;
  }
  auto message = boost::make_local_shared<UnaskedMessage>([this, reading, frame]() -> std::optional<Message> {
    Message request;
    request.command = reading;
    Message pushed = source_.Read(request, *frame);
    if (pushed.error != 0) return std::nullopt;  // the robot is not in this frame
    pushed.command = -reading;
    Stamp(pushed, source_.Shown(*frame));
    return pushed;
  });
  if (!MayKeep(*frame) || !source_.reads_alike()) message->message();
  return readings_.emplace_back(reading, std::move(message)).second;
}

Message WaitEnded(command::Id command, const StepResult& result, const std::string& new_owner) {
  switch (result.end) {
    case StepEnd::kReset:
      return ErrorReply(command, Error::kNotPossible, "reset");
    case StepEnd::kLoad:
      return ErrorReply(command, Error::kNotPossible, "load");
    case StepEnd::kRemoved:
      return ErrorReply(command, Error::kNotPossible, "the robot was taken out of the world");
    case StepEnd::kReplaced:
      return ErrorReply(
          command, Error::kOwned,
          "replaced by the first command of the new owner" + (new_owner.empty() ? "" : ", " + new_owner));
    case StepEnd::kPaused:
      return ErrorReply(command, Error::kNotPossible,
                        fmt::format("paused after {} of {} steps: step {} runs the rest", result.ran,
                                    result.asked, result.asked - result.ran));
    case StepEnd::kStopping:
    case StepEnd::kRan:
      break;
  }
  return ErrorReply(command, Error::kNotPossible, result.why.empty() ? "the daemon is stopping" : result.why);
}

std::string DescribeWaiting(std::span<const Awaited> awaiting) {
  if (awaiting.empty()) return {};
  const Awaited& first = awaiting.front();
  return fmt::format("waiting for {} ({}), {:.1f} s{}{}", first.robot, first.why, first.seconds,
                     first.cure.empty() ? "" : ": ", first.cure);
}

}  // namespace coopdyn
