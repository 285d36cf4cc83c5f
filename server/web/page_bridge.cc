// SPDX-License-Identifier: MIT
#include "server/web/page_bridge.h"

#include <boost/asio/post.hpp>
#include <utility>
#include <vector>

#include "protocol/codec.h"
#include "protocol/command_ids.h"
#include "protocol/module_tables.h"
#include "server/web/access.h"
#include "server/web/module_link.h"

namespace coopdyn {
namespace {

/// True for "/robot1/motors", not for "/simulation".
bool IsOfRobot(const std::string& module) {
  return module.rfind('/') != 0;
}

/// `text` without its final '\n's.
std::string Chomp(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

/// A call, ready to be sent or answered.
struct ResolvedCall {
  bool send = false;  // send `message` to the module; else it is the answer
  Message message;
  std::string note;      // of an answer: lines for the console, e.g. help
  bool changes = true;   // requires the right to change things
  bool verbose = false;  // the line was `verbose`
};

ResolvedCall Answer(Message message, std::string note = {}) {
  return {.send = false, .message = std::move(message), .note = std::move(note), .changes = false};
}

ResolvedCall Refuse(Error error, std::string text) {
  return Answer(ErrorReply(command::kUnreadable, error, std::move(text)));
}

ResolvedCall Send(Message message, const CommandTable& table) {
  const CommandSpec* spec = table.Find(message.command);
  const bool changes = spec == nullptr || !IsReadingCommand(spec->name);
  return {.send = true, .message = std::move(message), .note = {}, .changes = changes};
}

ResolvedCall ReadLine(const std::string& line, const CommandTable& table) {
  Decoded decoded = DecodeText(line + "\n", table, false);
  switch (decoded.status) {
    case DecodeStatus::kMessage:
      return Send(std::move(decoded.message), table);
    case DecodeStatus::kBad:
    case DecodeStatus::kFatal:
      return Answer(std::move(decoded.message));
    case DecodeStatus::kHelp:
      return Answer({}, HelpText(table));
    case DecodeStatus::kVerbose: {
      ResolvedCall answer = Answer({}, "# from now on every reply is explained");
      answer.verbose = true;
      return answer;
    }
    case DecodeStatus::kLeave:
      return Answer({}, "# close this window to leave");
    case DecodeStatus::kNothing:
    case DecodeStatus::kNeedMore:
      break;
  }
  return Answer({}, "# type help to see the commands");
}

/// Reads the line of `call`, or looks up its command's name in `table`, which is null if unknown.
ResolvedCall ResolveCall(const PageCall& call, const CommandTable* table) {
  if (table == nullptr) {
    if (call.line || !call.command_name.empty()) {
      return Refuse(Error::kUnknownCommand,
                    "the command names of " + call.module + " are unknown here: send the command's number");
    }
    return {.send = true, .message = call.message, .note = {}};
  }
  if (call.line) return ReadLine(*call.line, *table);
  if (call.command_name.empty()) return Send(call.message, *table);
  const CommandSpec* spec = table->Find(call.command_name);
  if (spec == nullptr) {
    const std::string nearest = table->Nearest(call.command_name);
    return Refuse(Error::kUnknownCommand, "unknown command " + call.command_name + " of " + call.module +
                                              (nearest.empty() ? "" : ": did you mean " + nearest + "?"));
  }
  Message message = call.message;
  message.command = spec->id;
  return Send(std::move(message), *table);
}

}  // namespace

PageBridge::PageBridge(boost::asio::io_context& context, const NameTable& names, const FrameBoard& frames,
                       PeerInfo peer, SendFunction send)
    : context_(context), names_(names), frames_(frames), peer_(std::move(peer)), send_(std::move(send)) {}

PageBridge::~PageBridge() {
  for (auto& [key, link] : links_) link.link->Close();
}

const CommandTable* PageBridge::TableOf(const std::string& name) const {
  const std::size_t slash = name.rfind('/');
  const std::string module = name.substr(slash + 1);
  const FramePtr frame = frames_.Latest();
  const bool has_scene = frame != nullptr && frame->scene != nullptr;
  const int robot = !has_scene || slash == 0 || slash == std::string::npos
                        ? -1
                        : frame->scene->FindRobot(name.substr(1, slash - 1));
  if (robot < 0) return FindModuleTable(module);
  for (const ModuleModel& one :
       frame->scene->robots[static_cast<std::size_t>(robot)].entry.model->modules()) {
    if (one.name == module) return FindModuleTable(one.type);
  }
  return nullptr;
}

void PageBridge::SetTrusted(bool trusted) {
  if (trusted == peer_.trusted) return;
  peer_.trusted = trusted;
  std::vector<Key> keys;
  for (const auto& [key, link] : links_) keys.push_back(key);
  for (const Key& key : keys) CloseLink(key.first, key.second);
}

void PageBridge::Handle(const PageCall& call) {
  ResolvedCall resolved = ResolveCall(call, TableOf(call.module));
  if (resolved.verbose) {
    Message refusal;
    if (Link* link = FindOrOpen({call.module, call.channel}, refusal)) link->verbose = true;
  }
  if (!resolved.send) return Answer(call, std::move(resolved.message), std::move(resolved.note));
  if (resolved.changes && !peer_.trusted && !IsOfRobot(call.module)) {
    return Answer(call, ErrorReply(resolved.message.command, Error::kNotAllowed, kTokenText));
  }
  if (waiting_ >= kMaxWaiting) {
    return Answer(call, ErrorReply(resolved.message.command, Error::kTooLarge,
                                   "too many pending requests: wait for some replies first"));
  }
  const Key key{call.module, call.channel};
  Message refusal;
  Link* link = FindOrOpen(key, refusal);
  if (link == nullptr) {
    refusal.command = resolved.message.command;
    return Answer(call, std::move(refusal));
  }
  ++waiting_;
  PageReply reply{
      .id = call.id, .module = call.module, .channel = call.channel, .message = {}, .line = {}, .note = {}};
  if (call.line) reply.sent = resolved.message;
  link->link->Call(resolved.message, [this, alive = std::weak_ptr(alive_), key, reply = std::move(reply),
                                      typed = call.line.has_value()](const Message& message) mutable {
    if (alive.expired()) return;
    --waiting_;
    reply.message = message;
    if (typed) {
      EncodeText(message, reply.line);
      reply.line = Chomp(std::move(reply.line));
      const auto found = links_.find(key);
      const CommandTable* table = TableOf(key.first);
      if (table != nullptr && found != links_.end() && found->second.verbose) {
        EncodeVerbose(message, *table, reply.note);
        reply.note = Chomp(std::move(reply.note));
      }
    }
    send_(reply);
  });
}

void PageBridge::CloseLink(const std::string& module, const std::string& channel) {
  const auto found = links_.find({module, channel});
  if (found == links_.end()) return;
  found->second.link->Abandon("the connection was closed by the page");
  links_.erase(found);
}

PageBridge::Link* PageBridge::FindOrOpen(const Key& key, Message& refusal) {
  const auto found = links_.find(key);
  if (found != links_.end() && found->second.link->is_open()) return &found->second;
  if (found != links_.end()) links_.erase(found);
  std::erase_if(links_, [](const auto& entry) { return !entry.second.link->is_open(); });
  if (links_.size() >= (peer_.trusted ? kMaxLinks : kMaxStrangersLinks)) {
    refusal = ErrorReply(0, Error::kNotPossible, "this page has too many connections open");
    return nullptr;
  }
  const std::optional<NameEntry> entry = names_.Find(key.first);
  if (!entry) {
    const std::string nearest = names_.Nearest(key.first);
    refusal = ErrorReply(
        0, Error::kNoSuchName,
        "there is no module " + key.first + (nearest.empty() ? "" : ": did you mean " + nearest + "?"));
    return nullptr;
  }
  if (entry->external) {
    refusal = ErrorReply(0, Error::kNotPossible,
                         key.first + " belongs to another program at " + entry->ip + ":" +
                             std::to_string(entry->port) + ", which the page does not talk to");
    return nullptr;
  }
  PeerInfo peer = peer_;
  // The address stays last: wrong tokens count for it.
  if (!person_.empty()) peer.text = person_ + ", " + peer.text;
  std::shared_ptr<ModuleLink> link = ModuleLink::Open(context_, *entry, std::move(peer));
  if (link == nullptr) {
    refusal = ErrorReply(0, Error::kInternal, "the daemon has no file descriptors left");
    return nullptr;
  }
  link->set_push_function([this, key](const Message& message) { Push(key, message); });
  return &(links_[key] = {std::move(link), false});
}

void PageBridge::Push(const Key& key, const Message& message) {
  send_({.id = {}, .module = key.first, .channel = key.second, .message = message, .line = {}, .note = {}});
}

void PageBridge::Answer(const PageCall& call, Message message, std::string note) {
  PageReply reply{.id = call.id,
                  .module = call.module,
                  .channel = call.channel,
                  .message = std::move(message),
                  .line = {},
                  .note = Chomp(std::move(note))};
  if (call.line && reply.note.empty()) {
    EncodeText(reply.message, reply.line);
    reply.line = Chomp(std::move(reply.line));
  }
  boost::asio::post(context_, [this, alive = std::weak_ptr(alive_), reply = std::move(reply)] {
    if (!alive.expired()) send_(reply);
  });
}

}  // namespace coopdyn
