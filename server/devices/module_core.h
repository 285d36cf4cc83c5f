// SPDX-License-Identifier: MIT
// What every module does alike, free of sockets: checks requests, answers the common commands that concern
// nobody else (ping, describe, get_time, subscribe, unsubscribe, attach), pushes readings, and stamps replies
// with time and step. One thread: the module's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/command_ids.h"
#include "protocol/command_table.h"
#include "protocol/message.h"
#include "server/base/wrong_tokens.h"
#include "server/net/endpoint.h"
#include "server/state/command_board.h"
#include "server/state/frame.h"

namespace coopdyn {

/// Where a module's readings come from.
class ReadingSource {
 public:
  virtual ~ReadingSource() = default;
  /// Answers a get-command that has been checked, without time_s and step.
  virtual Message Read(const Message& request, const Frame& frame) = 0;
  /// The moment that Read() shows: `frame`, or a sample before.
  virtual const Frame& Shown(const Frame& frame) { return frame; }
  /// The reading that `subscribe` takes if none is named.
  virtual command::Id first_reading() const = 0;
  /// Names that `attach` takes, e.g. motors, distance; and the first reading of one of them. Nothing is
  /// appended if the robot is not in the frame.
  virtual std::span<const std::string> attachable() const = 0;
  virtual void AppendReading(std::size_t attachable, const Frame& frame, std::vector<double>& data) = 0;
  /// Read() gives all clients the same.
  virtual bool reads_alike() const { return true; }
};

/// What a module keeps about one connection.
struct ModuleClient {
  struct Subscription {
    command::Id reading = 0;
    std::int32_t every = 1;    // steps
    std::int32_t left = 1;     // steps until the next one is due
    std::uint64_t missed = 0;  // due, but their frames were dropped
  };

  Client client;
  bool trusted = false;    // needs no token
  bool has_token = false;  // said the right one
  std::vector<Subscription> subscriptions;
  std::vector<std::size_t> attached;  // indices into ReadingSource::attachable()
};

class ModuleCore {
 public:
  /// All outlive it. `version` is the program's, for describe.
  ModuleCore(const CommandTable& table, ReadingSource& source, const TokenGuard& guard,
             std::string_view version)
      : table_(table), source_(source), guard_(guard), version_(version) {}

  /// The error reply to a request that its spec does not allow (errors 1, 2, 3, 4, 7); nothing if it is fine.
  std::optional<Message> Refuse(const Message& request) const;
  /// True if the client may change something; otherwise the caller answers NotAllowed().
  bool MayChange(const ModuleClient& client) const {
    return !guard_.required() || client.trusted || client.has_token;
  }
  static Message NotAllowed(const Message& request);
  /// A command that changes nothing and waits for nothing.
  static bool OnlyReads(const CommandSpec& spec);

  /// Answers ping, describe, get_time, subscribe, unsubscribe and attach, stamped by `frame`; nothing if the
  /// request is another one. @pre Refuse() had nothing to say.
  std::optional<Message> AnswerCommon(ModuleClient& client, const Message& request, const Frame& frame,
                                      Mode mode);
  /// `hello`: takes name and token into `client`; an error reply, or nothing if it is fine.
  std::optional<Message> TakeHello(ModuleClient& client, const Message& request, Nanoseconds now) const;

  /// The reply to an actuator command, `ready` or `get_time`: mode, lengths, readings, time and step.
  Message StepReply(const ModuleClient& client, command::Id command, std::string text, const Frame& frame,
                    Mode mode);
  /// Sends what is due after the step of `frame`; `dropped` frames before it never came. ForgetReadings()
  /// follows when all clients have got theirs. False: something waits, as the client takes nothing now.
  bool PushDue(Connection& connection, ModuleClient& client, const FramePtr& frame, int dropped);
  /// Sends `reading` of `frame` to a client that has subscribed to it.
  void PushAgain(Connection& connection, const ModuleClient& client, command::Id reading,
                 const FramePtr& frame);
  /// Whether frames like this one may be kept for those who do not read. A reading is little beside a step of
  /// many bodies.
  static bool MayKeep(const Frame& frame) { return frame.bodies.size() <= kMaxKeptBodies; }
  static constexpr std::size_t kMaxKeptBodies = 256;
  void ForgetReadings() { readings_.clear(); }
  /// Appends time_s and step.
  static void Stamp(Message& reply, const Frame& frame);

 private:
  Message Subscribe(ModuleClient& client, const Message& request) const;
  Message Unsubscribe(ModuleClient& client, const Message& request) const;
  Message Attach(ModuleClient& client, const Message& request) const;
  /// The reading to be pushed: one for all who want it, made when the first of them can take it.
  const UnaskedPtr& ReadingOf(command::Id reading, const FramePtr& frame);

  const CommandTable& table_;
  ReadingSource& source_;
  const TokenGuard& guard_;
  const std::string_view version_;
  std::vector<std::pair<command::Id, UnaskedPtr>> readings_;  // of the present frame
};

/// The error reply to a request whose wait for a step ended without it. `new_owner`: for kReplaced.
/// @pre result.end is not kRan
Message WaitEnded(command::Id command, const StepResult& result, const std::string& new_owner);
/// `waiting for robot2 (no client), 1.2 s: start its program, or …`; empty if nobody is awaited.
std::string DescribeWaiting(std::span<const Awaited> awaiting);
/// The words of `text`, separated by blanks.
std::vector<std::string> Words(std::string_view text);

}  // namespace coopdyn
