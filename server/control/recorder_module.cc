// SPDX-License-Identifier: MIT
#include "server/control/recorder_module.h"

#include <utility>

#include "protocol/module_tables.h"
#include "server/naming/run_names.h"

namespace coopdyn {

namespace {

EditResult ToEditResult(const RecordingDesk::Result& result, std::string text) {
  return {result.error, std::move(text), result.frame, nullptr};
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
  const auto answer = [later = Later(peer)](const RecordingDesk::Result& result) {
    later(ToEditResult(result, result.text));
  };
  switch (request.command) {
    case command::kStartRecording:
      desk_.Start(request.text, answer);
      break;
    case command::kStopRecording:
      desk_.Stop([later = Later(peer), page = page_()](const RecordingDesk::Result& result) {
        const bool copied = result.error == Error::kOk && result.in_folder;
        const std::string url = copied ? RunUrl(page, result.text) : "";
        later(ToEditResult(result, url.empty() ? result.text : result.text + " " + url));
      });
      break;
    case command::kNote:
      desk_.Note(request.text, answer);
      break;
    default:
      return ErrorReply(request.command, Error::kUnknownCommand,
                        "describe (1) lists the commands of /recorder");
  }
  return std::nullopt;
}

}  // namespace coopdyn
