// SPDX-License-Identifier: MIT
// coopdyn-files CPU_S MEMORY_MIB: reads files for coopdyn one at a time, see wire.h. Its stdin is the socket.
// The program opens no files itself, so a file that hijacks a library cannot reach other files.
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string>

#include "server/base/sanitizers.h"
#include "server/files/program/read_mesh.h"
#include "server/files/program/read_picture.h"
#include "server/files/wire.h"

namespace coopdyn {

namespace {

constexpr int kSocket = STDIN_FILENO;

void SetLimit(__rlimit_resource resource, rlim_t limit) {
  const rlimit both{limit, limit};
  setrlimit(resource, &both);
}

void LimitProcess([[maybe_unused]] long memory_mib) {
  SetLimit(RLIMIT_CORE, 0);
  if (std::FILE* file = std::fopen("/proc/self/oom_score_adj", "w"); file != nullptr) {
    std::fputs("1000", file);
    std::fclose(file);
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // these map terabytes and open files
  SetLimit(RLIMIT_DATA, static_cast<rlim_t>(memory_mib) << 20);
  SetLimit(RLIMIT_NOFILE, 3);
#endif
  std::set_new_handler([] { _exit(kNoMemoryExit); });
}

/// Limits the CPU time from now on.
void LimitTime(long cpu_s) {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  rlimit limit{};
  getrlimit(RLIMIT_CPU, &limit);
  // One more second, because the current one has begun.
  limit.rlim_cur = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1 + cpu_s);
  setrlimit(RLIMIT_CPU, &limit);
}

std::optional<std::string> Ask(FileTalk kind, const std::string& name, std::string& why) {
  std::optional<FileMessage> answer;
  if (SendMessage(kSocket, kind, ToBytes(name))) answer = ReceiveMessage(kSocket, -1);
  if (!answer) _exit(1);  // coopdyn no longer waits for the file
  if (answer->kind == FileTalk::kFile) return FileTextOf(answer->bytes);
  why = FileTextOf(answer->bytes);
  return std::nullopt;
}

FileMessage Answer(const FileMessage& message) {
  std::string why = "the request is invalid";
  const std::span picture(reinterpret_cast<const unsigned char*>(message.bytes.data()), message.bytes.size());
  switch (message.kind) {
    case FileTalk::kReadMesh: {
      const auto request = MeshRequestOf(message.bytes);
      const auto mesh = request ? ReadMesh(*request, &Ask, why) : std::nullopt;
      if (mesh) return {FileTalk::kMesh, ToBytes(*mesh)};
      break;
    }
    case FileTalk::kReadTexture:
      if (const auto image = DecodeTexture(picture, why)) return {FileTalk::kTexture, ToBytes(*image)};
      break;
    case FileTalk::kReadHeights:
      if (const auto heights = DecodeHeights(picture, why)) return {FileTalk::kHeights, ToBytes(*heights)};
      break;
    default:
      break;
  }
  return {FileTalk::kFailed, ToBytes(why)};
}

int Serve(long cpu_s) {
  while (const std::optional<FileMessage> message = ReceiveMessage(kSocket, -1)) {
    LimitTime(cpu_s);
    FileMessage answer;
    try {
      answer = Answer(*message);
    } catch (const std::exception& exception) {
      answer = {FileTalk::kFailed, ToBytes(std::string("it cannot be read: ") + exception.what())};
    }
    if (!SendMessage(kSocket, answer.kind, answer.bytes)) return 1;
  }
  return 0;
}

}  // namespace

}  // namespace coopdyn

int main(int argc, char** argv) {
  int type = 0;
  socklen_t size = sizeof(type);
  if (argc != 3 || getsockopt(STDIN_FILENO, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_STREAM) {
    std::fputs("coopdyn-files is started by coopdyn itself; write coopdyn serve SCENARIO\n", stderr);
    return 2;
  }
  coopdyn::LimitProcess(std::strtol(argv[2], nullptr, 10));
  _exit(coopdyn::Serve(std::strtol(argv[1], nullptr, 10)));  // skips the libraries' static destructors
}
