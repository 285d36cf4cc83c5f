// SPDX-License-Identifier: MIT
// Serves the world requests of YARS clients by sending them to /simulation like any client.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/net/endpoint.h"
#include "server/net/io_thread.h"
#include "server/net/net_services.h"
#include "server/state/frame_board.h"
#include "server/yars/world.h"

namespace coopdyn {

class YarsDesk final : public YarsWorld, private Connection {
 public:
  /// Any thread. All references must outlive the desk. `quits`: a client may end the daemon.
  YarsDesk(IoThread& control, NetServices& net, const FrameBoard& frames, bool quits)
      : control_(control), net_(net), frames_(frames), quits_(quits) {}

  /// Starts sending requests to `simulation`, which lives on the control thread. Control thread.
  void Open(Endpoint& simulation);
  /// Answers all pending and later requests with error 5. Control thread.
  void Close();

  bool quits() const override { return quits_; }
  void Ask(YarsOrder order, const Connection& asker, std::function<void(const Message&)> done) override;

 private:
  struct Job {
    std::deque<Message> requests;  // in order, up to the first that fails
    std::function<void(const Message&)> done;
    FramePtr before = nullptr;  // keep its seed over a reload; null: another seed is requested
  };

  // Connection
  ClientId id() const override { return id_; }
  const std::string& peer() const override { return peer_; }
  bool trusted() const override { return true; }
  bool input_ended() const override { return false; }
  bool output_ended() const override { return false; }
  bool Push(const UnaskedPtr& /*message*/, std::int64_t /*dropped*/) override { return true; }
  void Close(const std::string& /*reason*/) override {}

  /// Why `asker` may not give this order; empty if it may. Any thread.
  std::string Refusal(const YarsOrder& order, const Connection& asker) const;
  void Take(const YarsOrder& order, std::function<void(const Message&)> done);
  void Begin();
  void OnReply(const Message& reply);
  /// Whether the experiment's file differs from the running scenario or cannot be read.
  bool IsEdited(const std::shared_ptr<const Scenario>& scenario);
  /// After a reload, makes the following reset keep the seed in force, unless the edit has changed the file's
  /// seed.
  void KeepSeed(Job& job) const;

  IoThread& control_;
  NetServices& net_;
  const FrameBoard& frames_;
  const bool quits_;
  const std::string peer_ = "yars";
  /// Metadata that changes when a file is written or replaced.
  struct FileStamp {
    std::uint64_t device = 0, number = 0;
    std::int64_t bytes = 0, written_ns = 0, changed_ns = 0;
    bool operator==(const FileStamp&) const = default;
  };
  /// Nullopt if it is unavailable or a later change might produce the same stamp.
  static std::optional<FileStamp> StampOf(const std::string& file);

  // Control thread:
  Endpoint* simulation_ = nullptr;
  bool closed_ = false;
  std::vector<std::pair<YarsOrder, std::function<void(const Message&)>>> early_;  // before Open()
  // The running scenario equalled its file when the file had stamp_, so the file need not be read again.
  std::shared_ptr<const Scenario> unedited_;
  std::optional<FileStamp> stamp_;
  ClientId id_ = 0;
  std::deque<Job> jobs_;  // the first is in progress
};

}  // namespace coopdyn
