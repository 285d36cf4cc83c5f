// SPDX-License-Identifier: MIT
// What clients of YARS want of the world, asked of /simulation as any client would.
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
  /// Any thread. All outlive it. `quits`: a client may end the daemon.
  YarsDesk(IoThread& control, NetServices& net, const FrameBoard& frames, bool quits)
      : control_(control), net_(net), frames_(frames), quits_(quits) {}

  /// From now on it asks `simulation`, which lives on the control thread. Control thread.
  void Open(Endpoint& simulation);
  /// Answers all that is still to come with error 5. Control thread.
  void Close();

  bool quits() const override { return quits_; }
  void Ask(YarsOrder order, const Connection& asker, std::function<void(const Message&)> done) override;

 private:
  struct Job {
    std::deque<Message> requests;  // one after the other, up to the first that fails
    std::function<void(const Message&)> done;
    FramePtr before = nullptr;  // whose seed stays over a reload; null: another one is asked for
  };

  // Connection
  ClientId id() const override { return id_; }
  const std::string& peer() const override { return peer_; }
  bool trusted() const override { return true; }
  bool input_ended() const override { return false; }
  bool output_ended() const override { return false; }
  bool Push(const UnaskedPtr& /*message*/, std::int64_t /*dropped*/) override { return true; }
  void Close(const std::string& /*reason*/) override {}

  /// Why `asker` may not order it; empty: it may. Any thread.
  std::string Refusal(const YarsOrder& order, const Connection& asker) const;
  void Take(const YarsOrder& order, std::function<void(const Message&)> done);
  void Begin();
  void OnReply(const Message& reply);
  /// The file of the experiment is another one than what runs, or cannot be read.
  bool IsEdited(const std::shared_ptr<const Scenario>& scenario);
  /// After a reload: the reset that follows keeps the seed in force, unless the edit has changed that of the
  /// file.
  void KeepSeed(Job& job) const;

  IoThread& control_;
  NetServices& net_;
  const FrameBoard& frames_;
  const bool quits_;
  const std::string peer_ = "yars";
  /// What changes when a file is written or another one takes its place.
  struct FileStamp {
    std::uint64_t device = 0, number = 0;
    std::int64_t bytes = 0, written_ns = 0, changed_ns = 0;
    bool operator==(const FileStamp&) const = default;
  };
  /// Nothing: it cannot be told, or a later change might have the same.
  static std::optional<FileStamp> StampOf(const std::string& file);

  // Control thread:
  Endpoint* simulation_ = nullptr;
  bool closed_ = false;
  std::vector<std::pair<YarsOrder, std::function<void(const Message&)>>> early_;  // before Open()
  // What runs was its file's text when that had the stamp: it need not be read again.
  std::shared_ptr<const Scenario> unedited_;
  std::optional<FileStamp> stamp_;
  ClientId id_ = 0;
  std::deque<Job> jobs_;  // the first is under way
};

}  // namespace coopdyn
