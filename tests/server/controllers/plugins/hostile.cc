// SPDX-License-Identifier: MIT
// Drives straight on until step `at`, then does its `deed`.
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "clients/plugin/cpp_controller.h"
#include "tests/server/controllers/plugins/deeds.h"

namespace {

using namespace coopdyn;

volatile int zero = 0, many = 12345;
int* volatile nowhere = nullptr;

volatile int counter = 0;

[[noreturn]] void Spin() {
  for (;;) counter = zero;
}

[[noreturn]] void Sleep() {
  for (;;) pause();
}

int Recurse(int depth) {
  volatile char frame[4096];
  frame[0] = static_cast<char>(depth);
  if (zero == 1) return 0;
  return Recurse(depth + 1) + frame[0];
}

/// `count` numbers from `first` on.
void Fill(double* first, int count) {
  double* volatile place = first;  // hides the pointer's target from the compiler
  for (int i = 0; i < count; ++i) place[i] = 1;
}

/// Resizes every anonymous file of this process.
void ResizeFiles(off_t bytes) {
  for (int fd = 3; fd < 64; ++fd) {
    if (ftruncate(fd, bytes) != 0) continue;
  }
}

/// The file mapped at `place`; 0: none.
unsigned long FileAt(const void* place) {
  std::FILE* maps = std::fopen("/proc/self/maps", "r");
  if (maps == nullptr) return 0;
  const auto wanted = reinterpret_cast<std::uintptr_t>(place);
  unsigned long found = 0, first = 0, end = 0, inode = 0;
  char line[512];
  while (std::fgets(line, sizeof(line), maps) != nullptr) {
    if (std::sscanf(line, "%lx-%lx %*s %*s %*s %lu", &first, &end, &inode) != 3) continue;
    if (first <= wanted && wanted < end) found = inode;
  }
  std::fclose(maps);
  return found;
}

/// Writes zeros over all data that the daemon has written for it, in every possible way.
void OverwriteInputs(const coopdyn_readings& readings) {
  constexpr std::size_t kPage = 4096;
  static const char zeros[kPage] = {};
  const unsigned long inputs = FileAt(readings.distance_m);
  for (int fd = 3; fd < 64; ++fd) {
    struct stat status {};
    if (fstat(fd, &status) != 0 || status.st_ino != inputs) continue;
    void* mapped = mmap(nullptr, kPage, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (mapped != MAP_FAILED) std::memset(mapped, 0, kPage);
    if (pwrite(fd, zeros, kPage, 0) > 0) continue;
  }
  auto* page = reinterpret_cast<char*>(reinterpret_cast<std::uintptr_t>(readings.distance_m) & ~(kPage - 1));
  if (mprotect(page, kPage, PROT_READ | PROT_WRITE) == 0) std::memset(page, 0, kPage);
}

/// Endlessly increments every byte that it shares with the daemon and may write.
[[noreturn]] void OverwriteOutputs() {
  std::FILE* maps = std::fopen("/proc/self/maps", "r");
  char* begin = nullptr;
  char* end = nullptr;
  char line[512];
  while (maps != nullptr && std::fgets(line, sizeof(line), maps) != nullptr) {
    unsigned long first = 0, last = 0;
    char access[8] = "";
    if (std::sscanf(line, "%lx-%lx %7s", &first, &last, access) != 3) continue;
    if (std::strcmp(access, "rw-s") != 0 || std::strstr(line, "/memfd:") == nullptr) continue;
    begin = reinterpret_cast<char*>(first);
    end = reinterpret_cast<char*>(last);
  }
  for (char value = 1;; ++value) std::memset(begin, value, static_cast<std::size_t>(end - begin));
}

struct State {
  std::uint64_t steps;
};

struct Hostile {
  int deed;
  std::uint64_t at;
  State state;
};

void Misbehave(int deed, const coopdyn_readings& readings, coopdyn_command& command) {
  switch (deed) {
    case kThrowError:
      throw std::runtime_error("no way\n\033[31mout");
    case kThrowInt:
      throw 42;
    case kDivideByZero:
      command.forward_m_s = many / zero;
      break;
    case kNotANumber:
      command.forward_m_s = std::nan("");
      break;
    case kInfinity:
      command.turn_rad_s = HUGE_VAL;
      break;
    case kNotANumberInMessage:
      command.message_count = 2;
      command.message[1] = std::nan("");
      break;
    case kTooLongMessage:
      command.message_count = COOPDYN_MAX_MESSAGE + 1;
      break;
    case kSleep:
      Sleep();
    case kSpin:
      Spin();
    case kWriteNowhere:
      *nowhere = 1;
      break;
    case kWritePastCommand:
      Fill(command.message, 100);
      break;
    case kWriteReadings:
      const_cast<double&>(readings.distance_m[0]) = 1;
      break;
    case kAbort:
      std::abort();
    case kExit:
      std::exit(3);
    case kExitAtOnce:
      _exit(4);
    case kOverflowStack:
      command.forward_m_s = Recurse(0);
      break;
    case kKillItself:
      kill(getpid(), SIGKILL);
      Sleep();
    case kKillOnce:
      if (const char* marker = std::getenv("HOSTILE_MARKER"); marker != nullptr && unlink(marker) == 0) {
        kill(getpid(), SIGKILL);
        Sleep();
      }
      break;
    case kFork:
      if (fork() == 0) command.forward_m_s = 1;  // in a copy, which continues as if it were the process
      break;
    case kShrinkAreas:
      ResizeFiles(0);
      command.forward_m_s = std::nan("");
      break;
    case kGrowAreas:
      ResizeFiles(off_t{1} << 40);
      command.forward_m_s = std::nan("");
      break;
    case kWriteInputs:
      OverwriteInputs(readings);
      command.forward_m_s = std::nan("");
      break;
    case kOverwriteOutputs:
      OverwriteOutputs();
    case kOverwriteOutputsBeside:
      std::thread(OverwriteOutputs).detach();
      break;
    case kLeakWithNew:
      for (;;) std::memset(new char[1 << 20], 1, 1 << 20);
    case kLeakWithMalloc:
      for (;;) std::memset(std::malloc(1 << 20), 1, 1 << 20);
    default:
      break;
  }
}

const coopdyn_description* Describe() {
  static const coopdyn_option options[] = {{"deed", "what it does", 0, 0, 1000},
                                           {"at", "in this step", 5, 0, 1e9}};
  static const coopdyn_description description = {"misbehaves", COOPDYN_DISTANCES, sizeof(State), 2, options};
  return &description;
}

void* Create(const coopdyn_robot* /*robot*/, const double* options, char* error, size_t error_size) {
  const int deed = static_cast<int>(options[0]);
  if (deed == kCrashInCreate) *nowhere = 1;
  if (deed == kThrowInCreate) throw std::runtime_error("no wheels");
  if (deed == kRefuse) {
    std::snprintf(error, error_size, "it needs a hat");
    return nullptr;
  }
  if (deed == kRefuseSilently) return nullptr;
  if (deed == kHangInCreate) Spin();
  return new Hostile{deed, static_cast<std::uint64_t>(options[1]), {}};
}

void Reset(void* instance, uint64_t /*seed*/) {
  Hostile& hostile = *static_cast<Hostile*>(instance);
  if (hostile.deed == kCrashInReset) *nowhere = 1;
  hostile.state = {};
}

void Step(void* instance, const coopdyn_readings* readings, coopdyn_command* command) {
  Hostile& hostile = *static_cast<Hostile*>(instance);
  command->forward_m_s = 0.1;
  if (hostile.state.steps++ == hostile.at) Misbehave(hostile.deed, *readings, *command);
}

void Save(const void* instance, void* state) {
  const Hostile& hostile = *static_cast<const Hostile*>(instance);
  *static_cast<State*>(state) = hostile.state;
  if (hostile.state.steps <= hostile.at) return;
  if (hostile.deed == kThrowInSave) throw std::runtime_error("no room");
  if (hostile.deed == kSavePastState) Fill(static_cast<double*>(state), 100);
}

void Restore(void* instance, const void* state) {
  Hostile& hostile = *static_cast<Hostile*>(instance);
  if (hostile.deed == kCrashInRestore) *nowhere = 1;
  if (hostile.deed == kThrowInRestore) throw std::runtime_error("forgotten");
  hostile.state = *static_cast<const State*>(state);
}

void Destroy(void* instance) {
  if (static_cast<Hostile*>(instance)->deed == kHangInDestroy) Sleep();
  delete static_cast<Hostile*>(instance);
}

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  static const coopdyn_controller functions = {
      COOPDYN_CONTROLLER_VERSION, Describe, Create, Reset, Step, Save, Restore, Destroy};
  return &functions;
}
