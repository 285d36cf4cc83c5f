// SPDX-License-Identifier: MIT
// One client's connection to one module, in every encoding: bytes in, requests to the endpoint one at a time,
// replies and pushes out. Everything on the io thread, or in its Turn.
#pragma once

#include <sys/socket.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/asio/basic_stream_socket.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "protocol/codec.h"
#include "server/net/encoding.h"
#include "server/net/endpoint.h"
#include "server/net/handover.h"
#include "server/net/in_buffer.h"
#include "server/net/io_thread.h"
#include "server/net/net_services.h"
#include "server/net/out_queue.h"
#include "server/net/peer.h"
#include "server/net/socket_end.h"
#include "server/net/turn.h"
#include "server/net/waiting_note.h"

namespace coopdyn {

/// The endpoint is called from event handlers only, never from within Push(), Close() or a ReplyFunction, so
/// that it may call those while it walks its own lists.
class Session final : public Connection, public std::enable_shared_from_this<Session> {
 public:
  /// Any socket of a kind that EndOf() knows.
  using Socket = boost::asio::basic_stream_socket<boost::asio::generic::stream_protocol,
                                                  boost::asio::io_context::executor_type>;
  /// Asio wants a protocol; a session does not use it.
  static Socket::protocol_type AnyProtocol() { return {AF_UNSPEC, 0}; }
  /// Read ahead of a request that has not been answered yet; then the client has to wait.
  static constexpr std::size_t kMaxReadAhead = kMaxRequestBytes + (std::size_t{64} << 10);
  static constexpr int kMaxMalformed = 20;  // in a row
  /// How long a closing connection waits for its peer to read what is left and to close.
  static constexpr std::chrono::seconds kLinger{5};

  /// `on_end` is called once it is closed; until then the caller keeps the session. `poster` runs work on the
  /// thread of `context`.
  Session(boost::asio::io_context& context, Socket socket, ConnectionEnd end, Endpoint& endpoint,
          NetServices& services, const IoThread::Poster& poster, PeerInfo peer,
          std::function<void(ClientId)> on_end);

  /// Opens it at the endpoint and goes on with what `connection` holds besides its socket and peer.
  void Start(LooseConnection connection);
  /// Its encoding outlives the module or is not chosen yet, and it has not ended.
  bool may_leave() const;
  /// Ends here and goes elsewhere: `done` gets it when what is being read has been, on this thread, before
  /// on_end or instead of it; without a socket if it has ended meanwhile. @pre may_leave()
  void Leave(std::function<void(LooseConnection)> done);
  /// The server goes away: notice (as far as it can be written at once), OnClosed(), close. No on_end.
  void Abort(const std::string& reason);
  /// Ends the connection if its machine has died unseen by keepalive.
  void CheckPeerLives();

  ClientId id() const override { return id_; }
  const std::string& peer() const override { return peer_.text; }
  std::string_view party() const override {
    return encoding_ == nullptr ? std::string_view() : encoding_->party();
  }
  bool trusted() const override { return peer_.trusted; }
  bool input_ended() const override { return input_ended_; }
  std::shared_ptr<InputEnd> input_end() const override { return input_end_; }
  bool output_ended() const override { return write_dead_; }
  bool Push(const UnaskedPtr& message, std::int64_t dropped) override;
  void Close(const std::string& reason) override { Close(reason, spdlog::level::debug); }

 private:
  using ErrorCode = boost::system::error_code;
  using Timer = std::optional<boost::asio::steady_timer>;
  using Step = void (Session::*)();

  /// What Asio is to call: `then`, in the turn, unless that was called off or all has ended.
  auto Handler(Step then) {
    return [self = shared_from_this(), then](const ErrorCode& error = {}) {
      if (error) return;
      self->turn_.Run([&] {
        if (!self->closed_) ((*self).*then)();
      });
    };
  }
  void Post(Step then);
  void At(Timer& timer, std::chrono::steady_clock::time_point time, Step then);

  // Reading.
  /// Reads on, or rests while the client is far ahead.
  void StartRead();
  void OnRead(const ErrorCode& error, std::size_t count);
  void EndInput();
  void TellInputEnded();
  /// While reading rests, looks from time to time whether the client has gone.
  void WatchPeer();
  /// Ends the input when nothing has come for as long as end_ says.
  void WatchSilence();
  // Requests.
  void Process();
  void PostProcess();
  void GoOn();
  bool HandleNext();
  void TakeEncoding(std::unique_ptr<Encoding> encoding);
  void HandRequest(Message request, bool changes);
  /// Counts a request; what its reply is given to, on this thread.
  ReplyFunction AwaitReply();
  /// The command is not one that only reads.
  bool Changes(std::int32_t command) const;
  void OnReply(std::uint64_t serial, const Message& reply);
  /// Waits for `answer`, which may be given already.
  void Await(std::shared_ptr<AskedAnswer> answer);
  bool MayHandle() const { return !closing_ && !closed_ && !waiting_ && !blocked_ && !leave_; }
  // Writing.
  void Flush();
  void OnWritable();
  /// Acknowledges what came if it gets no answer: the client may hold the rest of a request back until then.
  void Acknowledge();
  /// Tells a person from time to time whom the request waits for.
  void WatchWait();
  void TellWaiting();
  // The end.
  void FinishIfDone();
  void Close(const std::string& reason, spdlog::level::level_enum level);
  void AwaitPeersEnd();
  void DeliverClosed();
  void HardClose();
  void HandOver();
  void StopTimers();
  void Log(spdlog::level::level_enum level, const std::string& text);
  /// Calls `function(endpoint)`; what it throws is logged. Returns false then.
  template <typename Function>
  bool CallEndpoint(Function&& function) {
    if (endpoint_ == nullptr) return true;
    try {
      function(*endpoint_);
      return true;
    } catch (const std::exception& error) {
      Log(spdlog::level::err, std::string("internal error: ") + error.what());
    } catch (...) {
      Log(spdlog::level::err, "internal error of unknown type");
    }
    return false;
  }

  boost::asio::io_context& context_;
  Turn& turn_;
  Socket socket_;
  const ConnectionEnd end_;
  const std::shared_ptr<SocketEnd> input_end_;
  Endpoint* endpoint_;  // null after OnClosed()
  NetServices& services_;
  const IoThread::Poster& poster_;
  const ClientId id_;
  const PeerInfo peer_;
  std::function<void(ClientId)> on_end_;

  InBuffer in_;
  std::unique_ptr<Encoding> encoding_;  // null: not chosen yet
  OutQueue out_;
  int malformed_ = 0;  // in a row

  std::uint64_t serial_ = 0;            // of the request handed out last
  bool waiting_ = false;                // for its reply
  std::shared_ptr<AskedAnswer> asked_;  // which may be this one
  std::optional<Message> asked_again_;  // of the module to come
  std::optional<Message> next_;         // what the encoding wants before it answers
  bool processing_ = false;             // Process() runs
  bool process_posted_ = false;
  bool reading_ = false;      // OnRead() follows when something comes, into the room of in_
  bool blocked_ = false;      // the peer takes nothing more; OnWritable() follows when it does
  bool acknowledged_ = true;  // what was read last
  bool write_dead_ = false;   // writing has failed: what is left is dropped
  bool input_ended_ = false;  // told to the endpoint
  bool eof_ = false;          // nothing more can be read
  bool closing_ = false;      // no more requests are handled
  bool fin_sent_ = false;
  bool closed_ = false;
  std::function<void(LooseConnection)> leave_;  // not null: it leaves when OnRead() has come

  Timer linger_timer_, watch_timer_, verbose_timer_;
  Timer silence_timer_;  // unless the stream ends it
  std::chrono::steady_clock::time_point heard_at_;
  WaitingNote waiting_note_;
  std::uint64_t watched_ = 0;  // the serial for which verbose_timer_ was set
};

}  // namespace coopdyn
