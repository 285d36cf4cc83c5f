// SPDX-License-Identifier: MIT
#include "server/app/bench_daemon.h"

#include <fcntl.h>
#include <signal.h>
#include <spdlog/fmt/fmt.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "server/app/options.h"

namespace coopdyn {

namespace {

namespace fs = std::filesystem;

constexpr double kThickness_m = 0.1;
constexpr const char* kWithRays = "bench_robot";  // the type with --rays

std::string Contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The model of `robot`, its distance sensors replaced by single rays all round.
std::string ModelWithRays(const std::string& robot, int rays, double range_m) {
  std::string model;
  for (const std::string& folder : DataFolders({})) {
    if (model.empty()) model = Contents(fs::path(folder) / "robots" / robot / "model.sdf");
  }
  constexpr std::string_view kBegin = "<coopdyn:distance_sensors", kEnd = "</coopdyn:distance_sensors>";
  const std::size_t begin = model.find(kBegin);
  const std::size_t end = model.find(kEnd);
  if (begin == std::string::npos || end == std::string::npos) {
    throw std::runtime_error("there is no robot " + robot +
                             " with distance sensors to replace: leave --rays out, or use --robot minibot");
  }
  const std::size_t radius = model.find("radius=\"", begin);
  const std::size_t height = model.find("height=\"", begin);
  const auto value = [&model, end](std::size_t at) {
    return at < end ? std::atof(model.c_str() + at + std::string_view("radius=\"").size()) : 0.05;
  };
  std::string sensors = fmt::format("{} radius=\"{}\" height=\"{}\" max_range=\"{}\" noise_stddev=\"0\">\n",
                                    kBegin, value(radius), value(height), range_m);
  for (int i = 0; i < rays; ++i) {
    sensors += fmt::format("<coopdyn:sector bearing_deg=\"{}\"/>\n", -180 + 360 * (i + 0.5) / rays);
  }
  return model.replace(begin, end - begin, sensors);
}

std::string ScenarioText(const BenchDaemonOptions& options) {
  const double inner = std::ceil(std::sqrt(options.robots));
  const double outer = inner + 2 * kThickness_m;
  const double middle = (inner + kThickness_m) / 2;
  std::string text = fmt::format("[SIMULATION]\nmode lockstep\n[FLOOR]\nsize {} {} 0.1\n", outer, outer);
  const auto wall = [&](int number, double length, double width, double x, double y) {
    text += fmt::format("[WALL_{}]\ntype box\nsize {} {} 0.3\nposition {} {}\n", number, length, width, x, y);
  };
  wall(1, outer, kThickness_m, 0, middle);
  wall(2, outer, kThickness_m, 0, -middle);
  wall(3, kThickness_m, inner, middle, 0);
  wall(4, kThickness_m, inner, -middle, 0);
  text +=
      fmt::format("[SWARM_1]\ntype {}\nname bot\ncount {}\nfidelity {}\narea 0 0 {} {}\n",
                  options.rays ? kWithRays : options.robot, options.robots, options.fidelity, inner, inner);
  return text;
}

void Write(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

BenchDaemon::BenchDaemon(const BenchDaemonOptions& options) {
  std::string folder = (fs::temp_directory_path() / "coopdyn-bench-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) throw std::runtime_error("cannot make a folder " + folder);
  folder_ = folder;
  try {
    Start(options);
  } catch (...) {
    End();
    throw;
  }
}

BenchDaemon::~BenchDaemon() {
  End();
}

void BenchDaemon::Start(const BenchDaemonOptions& options) {
  const fs::path folder = folder_, scenario = folder / "bench.scenario", said = folder / "said";
  if (options.rays) {
    const fs::path model = folder / "robots" / kWithRays;
    fs::create_directories(model);
    Write(model / "model.sdf", ModelWithRays(options.robot, *options.rays, options.range_m));
  }
  Write(scenario, ScenarioText(options));
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  std::vector<std::string> words{program,
                                 "serve",
                                 scenario.string(),
                                 "--port",
                                 "0",
                                 "--no-http",
                                 "--no-render",
                                 "--scenarios",
                                 folder_,
                                 "--log-level",
                                 "error",
                                 "--threads",
                                 std::to_string(options.threads)};
  if (options.robot_threads) {
    words.insert(words.end(), {"--robot-threads", std::to_string(*options.robot_threads)});
  }
  if (!options.record.empty()) {
    words.insert(words.end(), {"--record", folder / "bench.run", "--record-what", options.record});
  }
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int out[2];
  if (::pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  pid_ = ::fork();
  if (pid_ == 0) {
    const int log = ::open(said.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    ::dup2(out[1], STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    ::execv(program.c_str(), arguments.data());
    std::_Exit(127);
  }
  ::close(out[1]);
  std::string line;
  for (char c = 0; ::read(out[0], &c, 1) == 1 && c != '\n';) line += c;
  ::close(out[0]);
  constexpr std::string_view kNames = "names=";
  const std::size_t at = line.find(kNames);
  if (at == std::string::npos) throw std::runtime_error("the daemon did not start: " + Contents(said));
  const std::size_t begin = at + kNames.size();
  address_ = line.substr(begin, line.find(' ', begin) - begin);
}

void BenchDaemon::End() {
  if (pid_ > 0) {
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
  }
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

double CpuOf(pid_t pid) {
  double cpu_s = 0;
  std::error_code error;
  for (const auto& task : fs::directory_iterator(fmt::format("/proc/{}/task", pid), error)) {
    double ran_ns = 0;
    std::ifstream(task.path() / "schedstat") >> ran_ns;
    cpu_s += ran_ns * 1e-9;
  }
  return cpu_s;
}

}  // namespace coopdyn
