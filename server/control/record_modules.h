// SPDX-License-Identifier: MIT
// /recorder and /playback. Free of sockets. The control thread only.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "server/control/branch_desk.h"
#include "server/control/global_module.h"
#include "server/control/recording_desk.h"
#include "server/control/run_folder.h"
#include "server/state/run_control.h"

namespace coopdyn {

/// Starts and ends recordings of the run.
class RecorderModule final : public GlobalModule {
 public:
  /// Any thread. `page` returns the page's URL with a trailing slash, empty: none. All arguments outlive the
  /// module.
  RecorderModule(GlobalServices services, RecordingDesk& desk, RunFolder& runs,
                 std::function<std::string()> page, StepInbox::Post post);

 private:
  Message Read(const Message& request, const Frame& frame) override;
  command::Id first_reading() const override { return command::kGetRecording; }
  std::optional<Message> ReadLater(Peer& peer, const Message& request) override;
  std::optional<Message> Change(Peer& peer, const Message& request) override;

  /// Replies with `text`, or with the error that it is called with.
  std::function<void(std::string)> Ending(const Peer& peer, std::string text);

  RecordingDesk& desk_;
  RunFolder& runs_;
  const std::function<std::string()> page_;
};

/// Controls a playback. In a live run refuses all its commands but `open`.
class PlaybackModule final : public GlobalModule {
 public:
  /// Any thread. All arguments outlive the module.
  PlaybackModule(GlobalServices services, const RunControl& run, BranchDesk& branches, RunFolder& runs,
                 StepInbox::Post post);

 private:
  Message Read(const Message& request, const Frame& frame) override;
  command::Id first_reading() const override { return command::kGetPlayback; }
  std::optional<Message> Refuse(const Message& request) const override;
  std::optional<Message> Change(Peer& peer, const Message& request) override;

  const RunControl& run_;
  BranchDesk& branches_;
  RunFolder& runs_;
};

}  // namespace coopdyn
