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

/// The endpoint is called only from event handlers, never from within Push(), Close() or a ReplyFunction, so
/// an endpoint may call those while it walks its own lists.
class Session final : public Connection, public std::enable_shared_from_this<Session> {
 public:
  /// Any socket of a kind that EndOf() knows.
  using Socket = boost::asio::basic_stream_socket<boost::asio::generic::stream_protocol,
                                                  boost::asio::io_context::executor_type>;
  /// Asio wants a protocol; a session does not use one.
  static Socket::protocol_type AnyProtocol() { return {AF_UNSPEC, 0}; }
  /// Bytes read ahead of an unanswered request; beyond that the client must wait.
  static constexpr std::size_t kMaxReadAhead = kMaxRequestBytes + (std::size_t{64} << 10);
  static constexpr int kMaxMalformed = 20;  // in a row
  /// How long a closing connection waits for its peer to read the rest and to close.
  static constexpr std::chrono::seconds kLinger{5};

  /// `on_end` is called once the session is closed; the caller keeps it alive until then. `poster` runs work
  /// on the thread of `context`.
  Session(boost::asio::io_context& context, Socket socket, ConnectionEnd end, Endpoint& endpoint,
          NetServices& services, const IoThread::Poster& poster, PeerInfo peer,
          std::function<void(ClientId)> on_end);

  /// Opens the session at the endpoint and continues with everything in `connection` but its socket and peer.
  void Start(DetachedConnection connection);
  /// True while the session is open and its encoding outlives the module or is not chosen yet.
  bool may_leave() const;
  /// Detaches the socket after the current read and passes it to `done`, on this thread; passes an empty
  /// connection if the session has ended meanwhile. Also calls on_end. @pre may_leave()
  void Leave(std::function<void(DetachedConnection)> done);
  /// Closes at once because the server goes away: writes the notice as far as possible, calls OnClosed() but
  /// not on_end.
  void Abort(const std::string& reason);
  /// Ends the connection if its machine has died without keepalive noticing.
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

  /// A handler for Asio: calls `then` in the turn, unless the operation was cancelled or the session is
  /// closed.
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
  /// Starts the next read, or pauses while the client is far ahead.
  void StartRead();
  void OnRead(const ErrorCode& error, std::size_t count);
  void EndInput();
  void TellInputEnded();
  /// While reading is paused, checks periodically whether the client has gone.
  void WatchPeer();
  /// Ends the input when end_.silence has passed without a datagram.
  void WatchSilence();
  // Requests.
  void Process();
  void PostProcess();
  void Resume();
  bool HandleNext();
  void TakeEncoding(std::unique_ptr<Encoding> encoding);
  void HandRequest(Message request, bool changes);
  /// Counts a request and returns the function that accepts its reply, on this thread.
  ReplyFunction AwaitReply();
  /// True unless the command only reads.
  bool Changes(std::int32_t command) const;
  void OnReply(std::uint64_t serial, const Message& reply);
  /// Waits for `answer`, which may have arrived already.
  void Await(std::shared_ptr<PendingAnswer> answer);
  bool MayHandle() const { return !closing_ && !closed_ && !waiting_ && !blocked_ && !leave_; }
  // Writing.
  void Flush();
  void OnWritable();
  /// Acknowledges the last bytes if they got no answer: the client may hold back the rest of a request until
  /// then.
  void Acknowledge();
  /// Reports to a person from time to time whom the request waits for.
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
  /// Calls `function(endpoint)`. Logs exceptions; returns false then.
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

  std::uint64_t serial_ = 0;              // of the last request passed on
  bool waiting_ = false;                  // for the reply to that request
  std::shared_ptr<PendingAnswer> asked_;  // the pending answer of Incoming::ask; null: the endpoint replies
  std::optional<Message> asked_again_;    // the request to repeat at the successor
  std::optional<Message> next_;           // the encoding's next request before it answers
  bool processing_ = false;               // Process() runs
  bool process_posted_ = false;
  bool reading_ = false;      // a read into the room of in_ is pending
  bool blocked_ = false;      // the send buffer is full; OnWritable() follows
  bool acknowledged_ = true;  // the bytes read last
  bool write_dead_ = false;   // writing has failed: the rest is dropped
  bool input_ended_ = false;  // the endpoint has been notified
  bool eof_ = false;          // nothing more can be read
  bool closing_ = false;      // no more requests are handled
  bool fin_sent_ = false;
  bool closed_ = false;
  std::function<void(DetachedConnection)> leave_;  // not null: HandOver() follows the pending read

  Timer linger_timer_, watch_timer_, verbose_timer_;
  Timer silence_timer_;  // only for sockets without a stream
  std::chrono::steady_clock::time_point heard_at_;
  WaitingNote waiting_note_;
  std::uint64_t watched_ = 0;  // the serial for which verbose_timer_ was set
};

}  // namespace coopdyn
