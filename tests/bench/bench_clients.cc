// SPDX-License-Identifier: MIT
#include "tests/bench/bench_clients.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "clients/cpp/coopdyn_client.h"
#include "server/app/options.h"
#include "tests/bench/measures.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr int kHold = 50;  // rounds before the robots' speeds change

/// Forward [m/s] and turn [rad/s] of robot i in these rounds. The Python program below uses the same
/// formulas.
double Forward(int i, int phase) {
  return 0.05 + 0.05 * ((i * 7 + phase * 3) % 5) / 4.0;
}
double Turn(int i, int phase) {
  return -1.0 + 2.0 * ((i * 13 + phase * 5) % 9) / 8.0;
}

/// Arguments: folder of coopdyn.py, server, pid, robots, batch, readings, at rest, warm-up, rounds.
constexpr const char* kPythonProgram = R"(
import array, os, sys, time
sys.path.insert(0, sys.argv[1])
import coopdyn
server, (pid, robots, batch, readings, at_rest, warm_up, rounds) = sys.argv[2], map(int, sys.argv[3:])

def server_cpu():
    tasks = f"/proc/{pid}/task"
    return sum(float(open(f"{tasks}/{t}/schedstat").read().split()[0]) for t in os.listdir(tasks)) * 1e-9

def speeds(phase):
    if at_rest:
        return [(0.0, 0.0)] * robots
    return [(0.05 + 0.05 * ((i * 7 + phase * 3) % 5) / 4.0, -1.0 + 2.0 * ((i * 13 + phase * 5) % 9) / 8.0)
            for i in range(robots)]

sim = coopdyn.connect(server)
if batch:
    team = sim.team("bot")
    team.select(*(["pose", "distances"] if readings else ["pose"]))
else:
    bots = [sim.robot(f"bot_{i + 1}") for i in range(robots)]
for k in range(-warm_up, rounds):
    if k == 0:
        start, server_start, own_start = time.monotonic(), server_cpu(), time.process_time()
    if (k + warm_up) % 50 == 0:
        v = speeds((k + warm_up) // 50)
        flat = array.array("d", [x for pair in v for x in pair])
    if batch:
        s = team.step(flat)
    else:
        for bot, (forward, turn) in zip(bots, v):
            bot.set_velocity(forward, turn)
        sim.step()
        if readings:
            for bot in bots:
                bot.sense()
wall, server_used = time.monotonic() - start, server_cpu() - server_start
print(wall, server_used, time.process_time() - own_start, sim.hash(), flush=True)
)";

/// Runs `round(k)` for all rounds; returns the duration of those after the warm-up.
std::string Timed(const BenchClientOptions& options, pid_t server, client::Simulation& sim,
                  const std::function<void(int)>& round) {
  using std::chrono::steady_clock;
  for (int k = 0; k < options.warm_up; ++k) round(k);
  const double server_start = CpuOf_s(server), own_start = OwnCpu_s();
  const auto start = steady_clock::now();
  for (int k = 0; k < options.rounds; ++k) round(options.warm_up + k);
  const std::chrono::duration<double> wall = steady_clock::now() - start;
  const double server_used = CpuOf_s(server) - server_start, own_used = OwnCpu_s() - own_start;
  return fmt::format("{} {} {} {}\n", wall.count(), server_used, own_used, sim.hash());
}

std::string DriveTeam(const BenchClientOptions& options, pid_t server, client::Simulation& sim) {
  client::Team team = sim.team("bot");
  if (options.readings) {
    team.select({"pose", "distances"});
  } else {
    team.select({"pose"});
  }
  std::vector<double> v(2 * team.n());
  return Timed(options, server, sim, [&](int k) {
    for (int i = 0; k % kHold == 0 && !options.at_rest && i < options.robots; ++i) {
      v[2 * static_cast<std::size_t>(i)] = Forward(i, k / kHold);
      v[2 * static_cast<std::size_t>(i) + 1] = Turn(i, k / kHold);
    }
    team.step(v);
  });
}

std::string DriveEach(const BenchClientOptions& options, pid_t server, client::Simulation& sim) {
  std::vector<client::Robot> robots;
  for (int i = 0; i < options.robots; ++i) robots.push_back(sim.robot("bot_" + std::to_string(i + 1)));
  return Timed(options, server, sim, [&](int k) {
    for (int i = 0; i < options.robots; ++i) {
      client::Robot& robot = robots[static_cast<std::size_t>(i)];
      robot.set_velocity(options.at_rest ? 0 : Forward(i, k / kHold),
                         options.at_rest ? 0 : Turn(i, k / kHold));
    }
    sim.step();
    if (!options.readings) return;
    for (client::Robot& robot : robots) robot.sense();
  });
}

/// Runs in the client's process: drives, and writes the figures to stdout.
[[noreturn]] void RunCpp(const BenchDaemon& daemon, const BenchClientOptions& options) {
  int code = 1;
  try {
    client::Simulation sim = client::connect(daemon.address());
    const std::string figures =
        options.batch ? DriveTeam(options, daemon.pid(), sim) : DriveEach(options, daemon.pid(), sim);
    if (::write(STDOUT_FILENO, figures.data(), figures.size()) == static_cast<ssize_t>(figures.size()))
      code = 0;
  } catch (const std::exception& error) {
    const std::string text = fmt::format("coopdyn bench lockstep: {}\n", error.what());
    if (::write(STDERR_FILENO, text.data(), text.size()) < 0) code = 1;
  }
  std::_Exit(code);
}

std::string PythonClientFolder() {
  for (const fs::path& folder : DataPath({}).folders) {
    for (const char* place : {"clients/python", "python"}) {
      std::error_code ignored;
      if (fs::is_regular_file(fs::path(folder) / place / "coopdyn.py", ignored))
        return (fs::path(folder) / place).string();
    }
  }
  throw std::runtime_error(
      "coopdyn.py is not beside the program: set COOPDYN_PATH to the folder that has clients/python");
}

[[noreturn]] void RunPython(const BenchDaemon& daemon, const BenchClientOptions& options,
                            const std::string& folder) {
  std::vector<std::string> words{"python3", "-c", kPythonProgram, folder, daemon.address()};
  for (const int number :
       {static_cast<int>(daemon.pid()), options.robots, options.batch ? 1 : 0, options.readings ? 1 : 0,
        options.at_rest ? 1 : 0, options.warm_up, options.rounds}) {
    words.push_back(std::to_string(number));
  }
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execvp("python3", arguments.data());
  std::_Exit(127);
}

}  // namespace

BenchClientFigures DriveBench(const BenchDaemon& daemon, const BenchClientOptions& options) {
  const std::string folder = options.python ? PythonClientFolder() : "";
  int out[2];
  if (::pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  // This process has one thread, so the child may continue in it.
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(out[1], STDOUT_FILENO);
    if (options.python) RunPython(daemon, options, folder);
    RunCpp(daemon, options);
  }
  ::close(out[1]);
  std::string said;
  char bytes[256];
  for (ssize_t n = 0; (n = ::read(out[0], bytes, sizeof bytes)) > 0;)
    said.append(bytes, static_cast<std::size_t>(n));
  ::close(out[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  BenchClientFigures figures;
  std::istringstream words(said);
  if (status != 0 ||
      !(words >> figures.wall_s >> figures.server_cpu_s >> figures.client_cpu_s >> figures.hash)) {
    throw std::runtime_error(options.python
                                 ? "the Python client failed (python3 must be there); it says above why"
                                 : "the client failed; it says above why");
  }
  return figures;
}

}  // namespace coopdyn
