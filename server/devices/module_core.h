// SPDX-License-Identifier: MIT
// The part that all modules share, free of sockets: checks requests, answers the common commands that do not
// depend on the module (ping, describe, get_time, subscribe, unsubscribe, attach), pushes readings, and
// stamps replies with time and step. One thread: the module's.
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

/// The source of a module's readings.
class ReadingSource {
 public:
  virtual ~ReadingSource() = default;
  /// Answers a checked get-command, without time_s and step.
  virtual Message Read(const Message& request, const Frame& frame) = 0;
  /// The frame that Read() shows: `frame` or an earlier sample.
  virtual const Frame& Shown(const Frame& frame) { return frame; }
  /// The default reading of `subscribe`.
  virtual command::Id first_reading() const = 0;
  /// The names that `attach` accepts, e.g. motors, distance. AppendReading() appends the first reading of one
  /// of them; nothing if the robot is not in the frame.
  virtual std::span<const std::string> attachable() const = 0;
  virtual void AppendReading(std::size_t attachable, const Frame& frame, std::vector<double>& data) = 0;
  /// True if Read() gives all clients the same answer.
  virtual bool reads_alike() const { return true; }
};

/// A module's data about one connection.
struct ModuleClient {
  struct Subscription {
    command::Id reading = 0;
    std::int32_t every = 1;    // steps
    std::int32_t left = 1;     // steps until the next push
    std::uint64_t missed = 0;  // pushes that were due in dropped frames
  };

  Client client;
  bool trusted = false;    // needs no token
  bool has_token = false;  // has sent the right one
  std::vector<Subscription> subscriptions;
  std::vector<std::size_t> attached;  // indices into ReadingSource::attachable()
};

class ModuleCore {
 public:
  /// All arguments outlive it. `version` is the program's, for describe.
  ModuleCore(const CommandTable& table, ReadingSource& source, const TokenGuard& guard,
             std::string_view version)
      : table_(table), source_(source), guard_(guard), version_(version) {}

  /// The error reply to a request that its spec does not allow (errors 1, 2, 3, 4, 7); nullopt if it is
  /// valid.
  std::optional<Message> Refuse(const Message& request) const;
  /// True if the client may change state; otherwise answer NotAllowed().
  bool MayChange(const ModuleClient& client) const {
    return !guard_.required() || client.trusted || client.has_token;
  }
  static Message NotAllowed(const Message& request);
  /// True for commands that change nothing and wait for nothing.
  static bool OnlyReads(const CommandSpec& spec);

  /// Answers ping, describe, get_time, subscribe, unsubscribe and attach, stamped with `frame`; nullopt for
  /// any other request. @pre Refuse() returned nullopt.
  std::optional<Message> AnswerCommon(ModuleClient& client, const Message& request, const Frame& frame,
                                      Mode mode);
  /// `hello`: stores name and token in `client`. Returns an error reply, or nullopt on success.
  std::optional<Message> TakeHello(ModuleClient& client, const Message& request, Nanoseconds now) const;

  /// The reply to an actuator command, `ready` or `get_time`: mode, lengths, readings, time and step.
  Message StepReply(const ModuleClient& client, command::Id command, std::string text, const Frame& frame,
                    Mode mode);
  /// Sends the pushes that are due after the step of `frame`; `dropped` frames before it were lost. Call
  /// ForgetReadings() after the last client. Returns false if pushes wait because the client accepts nothing
  /// now.
  bool PushDue(Connection& connection, ModuleClient& client, const FramePtr& frame, int dropped);
  /// Sends `reading` of `frame` to the client if it has subscribed to it.
  void PushAgain(Connection& connection, const ModuleClient& client, command::Id reading,
                 const FramePtr& frame);
  /// Whether such frames may be kept for clients that do not read. With many bodies, composing the reading at
  /// once is cheap in comparison.
  static bool MayKeep(const Frame& frame) { return frame.bodies.size() <= kMaxKeptBodies; }
  static constexpr std::size_t kMaxKeptBodies = 256;
  void ForgetReadings() { readings_.clear(); }
  /// Appends time_s and step.
  static void Stamp(Message& reply, const Frame& frame);

 private:
  Message Subscribe(ModuleClient& client, const Message& request) const;
  Message Unsubscribe(ModuleClient& client, const Message& request) const;
  Message Attach(ModuleClient& client, const Message& request) const;
  /// The push of a reading: shared by all subscribers, composed when the first of them can send it.
  const UnaskedPtr& ReadingOf(command::Id reading, const FramePtr& frame);

  const CommandTable& table_;
  ReadingSource& source_;
  const TokenGuard& guard_;
  const std::string_view version_;
  std::vector<std::pair<command::Id, UnaskedPtr>> readings_;  // of the current frame
};

/// The error reply to a request whose wait for a step has failed. `new_owner`: for kReplaced. @pre result.end
/// is not kRan
Message WaitEnded(command::Id command, const StepResult& result, const std::string& new_owner);
/// `waiting for robot2 (no client), 1.2 s: start its program, or …`; empty if nobody is awaited.
std::string DescribeWaiting(std::span<const Awaited> awaiting);
/// The words of `text`, separated by blanks.
std::vector<std::string> Words(std::string_view text);

}  // namespace coopdyn
