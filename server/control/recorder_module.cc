// SPDX-License-Identifier: MIT
#include "server/control/recorder_module.h"

#include <utility>

#include "protocol/module_tables.h"

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
    default:
      return ErrorReply(request.command, Error::kUnknownCommand,
                        "describe (1) lists the commands of /recorder");
  }
  return std::nullopt;
}

}  // namespace coopdyn
