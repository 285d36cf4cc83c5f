// SPDX-License-Identifier: MIT
#include "server/control/record_modules.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "protocol/common_commands.h"
#include "protocol/module_tables.h"
#include "server/record/player.h"

namespace coopdyn {

namespace {

/// Far beyond any run, and well within 64 bits.
constexpr double kLongest_s = 1e9;

Nanoseconds ToNanoseconds(double time_s) {
  return std::llround(std::clamp(time_s, -kLongest_s, kLongest_s) * 1e9);
}

}  // namespace

RecorderModule::RecorderModule(GlobalServices services, RecordingDesk& desk, RunFolder& runs,
                               std::function<std::string()> page, StepInbox::Post post)
    : GlobalModule(std::move(services), RecorderTable(), std::move(post)),
      desk_(desk),
      runs_(runs),
      page_(std::move(page)) {}

Message RecorderModule::Read(const Message& request, const Frame& /*frame*/) {
  const RecordingStatus status = desk_.status();
  Message reply = ReplyTo(request.command, status.name);
  reply.params = {status.recording ? 1 : 0};
  reply.data = {ToSeconds(status.file.begin), ToSeconds(status.file.end),
                static_cast<double>(status.file.steps), static_cast<double>(status.file.lost),
                static_cast<double>(status.file.bytes)};
  return reply;
}

std::optional<Message> RecorderModule::ReadLater(Peer& peer, const Message& request) {
  if (request.command != command::kListRuns) return GlobalModule::ReadLater(peer, request);
  runs_.List([later = Later(peer), page = page_()](const std::vector<RunFile>& files) {
    EditResult result;
    result.text = RunsJson(files, page);
    later(result);
  });
  return std::nullopt;
}

std::optional<Message> RecorderModule::Change(Peer& peer, const Message& request) {
  switch (request.command) {
    case command::kStartRecording:
      desk_.Start(request.text, Later(peer));
      break;
    case command::kStopRecording:
      desk_.Stop(page_(), Later(peer));
      break;
    case command::kNote:
      desk_.Note(request.text, Later(peer));
      break;
    default:
      return ErrorReply(request.command, Error::kUnknownCommand,
                        "describe (1) lists the commands of /recorder");
  }
  return std::nullopt;
}

PlaybackModule::PlaybackModule(GlobalServices services, const RunControl& run, BranchDesk& branches,
                               ApplyScene apply_scene, StepInbox::Post post)
    : GlobalModule(std::move(services), PlaybackTable(), std::move(post)),
      run_(run),
      branches_(branches),
      apply_scene_(std::move(apply_scene)) {}

Message PlaybackModule::Read(const Message& request, const Frame& /*frame*/) {
  const std::optional<PlaybackStatus> playback = run_.playback();
  if (!playback) return ErrorReply(request.command, Error::kNotPossible, kNotPlayingText);
  Message reply = ReplyTo(request.command, std::filesystem::path(playback->file).filename().string());
  reply.params = {playback->playing, playback->loop, playback->growing};
  reply.data = {ToSeconds(playback->begin), ToSeconds(playback->end), ToSeconds(playback->time),
                playback->speed};
  return reply;
}

std::optional<Message> PlaybackModule::Refuse(const Message& request) const {
  if (std::optional<Message> refusal = GlobalModule::Refuse(request)) return refusal;
  const bool own = request.command >= static_cast<command::Id>(kCommonCommandCount);
  if (own && !run_.playback()) return ErrorReply(request.command, Error::kNotPossible, kNotPlayingText);
  const bool sets_speed = request.command == command::kSetPlaySpeed || request.command == command::kPlay;
  if (sets_speed && !request.data.empty()) {
    const double factor = request.data[0];
    if (factor < kMinPlaySpeed || factor > kMaxPlaySpeed || factor == 0) {
      return ErrorReply(request.command, Error::kOutOfRange,
                        fmt::format("a recording is played at {} to {} times its speed, not 0; below 0 it "
                                    "goes backwards: play 2, pause to stand",
                                    kMinPlaySpeed, kMaxPlaySpeed));
    }
  }
  if (request.command == command::kSkip && !request.params.empty() && request.params[0] == 0) {
    return ErrorReply(request.command, Error::kOutOfRange,
                      "step takes a number of steps, below 0 to go back, not 0: step 1");
  }
  return std::nullopt;
}

std::optional<Message> PlaybackModule::Change(Peer& peer, const Message& request) {
  switch (request.command) {
    case command::kSeek:
      return Push(peer, edit::Seek{ToNanoseconds(request.data[0])});
    case command::kPlay:
      if (!request.data.empty()) edits().Push({edit::SetPlaySpeed{request.data[0]}});
      return Push(peer, edit::Run{});
    case command::kPausePlayback:
      return Push(peer, edit::Pause{});
    case command::kSetPlaySpeed:
      return Push(peer, edit::SetPlaySpeed{request.data[0]});
    case command::kSkip:
      return Push(peer, edit::Skip{request.params.empty() ? 1 : request.params[0]});
    case command::kSetLoop:
      return Push(peer, edit::SetLoop{request.params[0] == 1});
    case command::kBranch: {
      const auto time_s = request.data.empty() ? std::nullopt : std::optional(request.data[0]);
      branches_.Branch(time_s, Later(peer, [this](const EditResult& result) {
                         if (result.error == Error::kOk) apply_scene_(*result.frame->scene);
                       }));
      return std::nullopt;
    }
    default:
      return ErrorReply(request.command, Error::kUnknownCommand,
                        "describe (1) lists the commands of /playback");
  }
}

}  // namespace coopdyn
