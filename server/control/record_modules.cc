// SPDX-License-Identifier: MIT
#include "server/control/record_modules.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "protocol/common_commands.h"
#include "protocol/module_tables.h"
#include "server/naming/run_names.h"
#include "server/state/run_input.h"

namespace coopdyn {

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
    case command::kDeleteRun:
      runs_.Delete(request.text, Ending(peer, {}));
      break;
    case command::kRenameRun: {
      const std::size_t slash = request.text.find('/');
      if (slash == std::string::npos) {
        return ErrorReply(request.command, Error::kOutOfRange,
                          "write the name, a slash and the new name: rename lesson1/reached the target");
      }
      const std::string to = request.text.substr(slash + 1);
      runs_.Rename(request.text.substr(0, slash), to, Ending(peer, WithRunExtension(to)));
      break;
    }
    default:
      return ErrorReply(request.command, Error::kUnknownCommand,
                        "describe (1) lists the commands of /recorder");
  }
  return std::nullopt;
}

std::function<void(std::string)> RecorderModule::Ending(const Peer& peer, std::string text) {
  return [later = Later(peer), text = std::move(text)](const std::string& error) {
    EditResult result;
    if (!error.empty()) result.error = Error::kNotPossible;
    result.text = error.empty() ? text : error;
    later(result);
  };
}

PlaybackModule::PlaybackModule(GlobalServices services, const RunControl& run, BranchDesk& branches,
                               RunFolder& runs, StepInbox::Post post)
    : GlobalModule(std::move(services), PlaybackTable(), std::move(post)),
      run_(run),
      branches_(branches),
      runs_(runs) {}

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
  if (own && request.command != command::kOpenRecording && !run_.playback())
    return ErrorReply(request.command, Error::kNotPossible, kNotPlayingText);
  return std::nullopt;
}

std::optional<Message> PlaybackModule::Change(Peer& peer, const Message& request) {
  auto answer = LaterAllServe(peer);
  if (request.command == command::kBranch) {
    branches_.Branch(request.data.empty() ? std::nullopt : std::optional(request.data[0]), std::move(answer));
    return std::nullopt;
  }
  if (request.command == command::kCloseRecording) {
    branches_.Resume(std::move(answer));
    return std::nullopt;
  }
  if (request.command == command::kOpenRecording) {
    const std::string name = request.text.ends_with(".run") ? request.text : request.text + ".run";
    runs_.Open(name, [this, answer = std::move(answer)](const RunToCopy& run) {
      if (run.error == Error::kOk) return branches_.Play(run.file.string(), answer);
      answer({run.error, run.text});
    });
    return std::nullopt;
  }
  std::string error;
  std::vector<EditAction> asked = PlaybackEditsOf(request, error);
  if (!error.empty()) return ErrorReply(request.command, Error::kOutOfRange, std::move(error));
  if (asked.empty()) {
    return ErrorReply(request.command, Error::kUnknownCommand,
                      "describe (1) lists the commands of /playback");
  }
  for (std::size_t i = 0; i + 1 < asked.size(); ++i) edits().Push({std::move(asked[i])});
  return Push(peer, std::move(asked.back()));
}

}  // namespace coopdyn
