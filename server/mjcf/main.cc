// SPDX-License-Identifier: MIT
// coopdyn-mjcf FILE FOLDER PREFIX: writes the MJCF model FILE as an SDF world to stdout and its meshes to
// FOLDER; the SDF refers to them as PREFIX + name. Writes lines `warning: …` to stderr, or an error and then
// exits with code 1. coopdyn starts this program so that a file that crashes libmujoco does not end the
// daemon.
#include <mujoco/mujoco.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <new>
#include <string>

#include "server/base/sanitizers.h"
#include "server/mjcf/load.h"
#include "server/mjcf/meshes.h"
#include "server/mjcf/source.h"
#include "server/mjcf/words.h"
#include "server/mjcf/world.h"

namespace coopdyn::mjcf {

namespace {

void SetLimit(__rlimit_resource resource, rlim_t limit) {
  const rlimit both{limit, limit};
  setrlimit(resource, &both);
}

[[noreturn]] void Fail(const char* why) {
  std::fputs(why, stderr);
  std::fputc('\n', stderr);
  std::fflush(stderr);
  _exit(1);
}

void LimitProcess() {
  constexpr rlim_t kCpu_s = 60;
  SetLimit(RLIMIT_CORE, 0);
  SetLimit(RLIMIT_CPU, kCpu_s);
  SetLimit(RLIMIT_FSIZE, rlim_t{1} << 30);
  std::signal(SIGXFSZ, SIG_IGN);
  // End if the parent process is killed, or if reading blocks forever.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::alarm(2 * kCpu_s);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers map terabytes
  SetLimit(RLIMIT_DATA, rlim_t{4} << 30);
#endif
  std::set_new_handler([] { Fail("reading it takes more than 4 GiB of memory: simplify it"); });
  // libmujoco's default handlers write a file, wait for Enter and end the process.
  mju_user_error = [](const char* text) { Fail(text); };
  mju_user_warning = [](const char* text) { std::fprintf(stderr, "warning: %s\n", text); };
}

int Run(const std::string& file, const std::string& folder, const std::string& prefix) {
  Words words;
  const Loaded loaded = Load(file, words);
  if (loaded.model == nullptr) Fail(loaded.why.c_str());
  const Source source(loaded, words);
  Meshes meshes(source, folder, prefix);
  const std::string text = WriteWorld(source, meshes);
  if (meshes.failed()) Fail(("its meshes cannot be written to " + folder).c_str());
  for (const std::string& line : words.Lines()) std::fprintf(stderr, "warning: %s\n", line.c_str());
  std::fwrite(text.data(), 1, text.size(), stdout);
  return std::fflush(stdout) == 0 ? 0 : 1;
}

}  // namespace

}  // namespace coopdyn::mjcf

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("coopdyn-mjcf is started by coopdyn itself; write coopdyn convert model.xml\n", stderr);
    return 2;
  }
  coopdyn::mjcf::LimitProcess();
  _exit(coopdyn::mjcf::Run(argv[1], argv[2], argv[3]));  // skips libmujoco's static destructors
}
