// SPDX-License-Identifier: MIT
#include "server/files/file_reader.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

#include "server/base/spawn.h"

namespace coopdyn {

namespace {

constexpr int kSilence_s =
    60;  // longer than the CPU limit: a process silent for this long is stuck or starved of CPU
constexpr const char* kConvert = "export it again, for example with Blender";

}  // namespace

bool FileReader::Start(std::string& why) {
  if (process_ > 0) return true;
  const std::filesystem::path program = OwnProgram(kFilesProgram);
  if (program.empty()) {
    why = std::string("coopdyn reads it by the program ") + kFilesProgram +
          ", which is not beside it: build all of coopdyn again (./start)";
    return false;
  }
  std::array<int, 2> ends{-1, -1};
  const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  int code =
      ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0 && nothing >= 0 ? 0 : errno;
  if (code == 0) {
    code = Spawn(program, {std::to_string(limits_.cpu_s), std::to_string(limits_.memory_mib)},
                 {ends[1], nothing, STDERR_FILENO}, process_);
  }
  ::close(ends[1]);
  ::close(nothing);
  socket_ = ends[0];
  if (code == 0) return true;
  process_ = -1;
  End();
  why = program.string() + " cannot be started: " + std::strerror(code);
  return false;
}

int FileReader::End() {
  ::close(std::exchange(socket_, -1));
  if (process_ < 0) return 0;
  ::kill(process_, SIGKILL);
  return WaitFor(std::exchange(process_, -1));
}

std::string FileReader::WhyEnded(int status) const {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU)
      return "reading it takes more than " + std::to_string(limits_.cpu_s) +
             " s of CPU time: simplify it, or " + kConvert;
    if (signal == SIGKILL)
      return "reading it took more than " + std::to_string(kSilence_s) +
             " s, or its process was killed: try again";
  } else if (WEXITSTATUS(status) == kNoMemoryExit) {
    return "reading it takes more than " + std::to_string(limits_.memory_mib) +
           " MiB of memory: simplify it, or " + kConvert;
  }
  return "the library that reads it crashed: the file is damaged; " + std::string(kConvert);
}

std::optional<std::vector<std::byte>> FileReader::Ask(FileTalk kind, std::span<const std::byte> bytes,
                                                      const Supply& supply, FileTalk wanted,
                                                      std::string& why) {
  if (!Start(why)) return std::nullopt;
  bool alive = SendMessage(socket_, kind, bytes);
  if (!alive) {  // the process has been killed since the last file
    End();
    if (!Start(why)) return std::nullopt;
    alive = SendMessage(socket_, kind, bytes);
  }
  while (alive) {
    std::optional<FileMessage> message = ReceiveMessage(socket_, kSilence_s);
    if (!message) break;
    if (message->kind == wanted) return std::move(message->bytes);
    if (message->kind == FileTalk::kFailed) {
      why = FileTextOf(message->bytes);
      return std::nullopt;
    }
    if (message->kind != FileTalk::kNeedFile && message->kind != FileTalk::kNeedPicture) break;
    std::string none = "a picture names no files";
    const auto content =
        supply ? supply(message->kind == FileTalk::kNeedPicture, FileTextOf(message->bytes), none)
               : std::nullopt;
    alive =
        SendMessage(socket_, content ? FileTalk::kFile : FileTalk::kNoFile, ToBytes(content.value_or(none)));
  }
  why = WhyEnded(End());
  return std::nullopt;
}

std::optional<MeshAnswer> FileReader::ReadMesh(const MeshRequest& request, const Supply& supply,
                                               std::string& why) {
  const auto bytes = Ask(FileTalk::kReadMesh, ToBytes(request), supply, FileTalk::kMesh, why);
  if (!bytes) return std::nullopt;
  auto answer = MeshAnswerOf(*bytes);
  if (!answer) why = "the library returned invalid data: the file is damaged; " + std::string(kConvert);
  return answer;
}

std::shared_ptr<const Image> FileReader::ReadTexture(std::string_view picture, std::string& why) {
  const auto bytes =
      Ask(FileTalk::kReadTexture, std::as_bytes(std::span(picture)), {}, FileTalk::kTexture, why);
  auto image = bytes ? ImageOf(*bytes) : std::nullopt;
  if (!image) return nullptr;
  return std::make_shared<const Image>(std::move(*image));
}

std::optional<Heights> FileReader::ReadHeights(std::string_view picture, std::string& why) {
  const auto bytes =
      Ask(FileTalk::kReadHeights, std::as_bytes(std::span(picture)), {}, FileTalk::kHeights, why);
  return bytes ? HeightsOf(*bytes) : std::nullopt;
}

}  // namespace coopdyn
