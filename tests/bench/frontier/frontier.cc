// SPDX-License-Identifier: MIT
// Usage: frontier [STEP_MS ...] [CASE ...]: a JSON line for each case, engine and step.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/bench/frontier/cases.h"

namespace coopdyn::frontier {

Vector3 InertiaOf(const Body& body) {
  return body.inertia_kg_m2.isZero() ? SolidInertia(body.shape, body.mass_kg) : body.inertia_kg_m2;
}

namespace {

using Make = std::function<std::unique_ptr<Engine>(const Setup&, double step_s)>;

double CpuTime_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Take {
  Film film;
  double cpu_s = 0;  // only of the steps
};

Take Shoot(const Case& of, const Make& make, double step_s) {
  Take take;
  const auto engine = make(of.setup, step_s);
  take.film.push_back(engine->Motions());
  const auto steps = static_cast<int>(std::lround(kSample_s / step_s));
  for (double t_s = 0; t_s < of.duration_s - kSample_s / 2; t_s += kSample_s) {
    const double start_s = CpuTime_s();
    engine->Run(steps);
    take.cpu_s += CpuTime_s() - start_s;
    take.film.push_back(engine->Motions());
  }
  return take;
}

/// Runs the case three times; repeats short runs until they can be measured, and very long ones less often.
void Measure(const Case& of, const std::string& engine, const Make& make, double step_ms) {
  constexpr double kEnough_s = 0.1, kTooLong_s = 10, kExploded = 1e4;  // in the unit of the case
  const double step_s = 1e-3 * step_ms;
  std::vector<double> times_s;
  double sum_s = 0, error = 0;
  while (sum_s < kTooLong_s && (times_s.size() < 3 || (sum_s < kEnough_s && times_s.size() < 100))) {
    const Take take = Shoot(of, make, step_s);
    error = of.error(take.film);
    times_s.push_back(take.cpu_s);
    sum_s += take.cpu_s;
  }
  std::ranges::nth_element(times_s, times_s.begin() + static_cast<std::ptrdiff_t>(times_s.size() / 2));
  const double cpu_s = times_s[times_s.size() / 2];
  const std::string figure = error < kExploded ? std::to_string(error) : "null";
  std::printf(
      R"({"case": "%s", "title": "%s", "unit": "%s", "floor": %g, "engine": "%s", "step_ms": %g, "error": %s, )"
      R"("us_per_step": %.4g, "ms_per_s": %.4g})"
      "\n",
      of.name.c_str(), of.title.c_str(), of.unit.c_str(), of.floor, engine.c_str(), step_ms, figure.c_str(),
      1e6 * cpu_s * step_s / of.duration_s, 1e3 * cpu_s / of.duration_s);
}

/// Runs in a separate process: an explosion may crash the program, or never end.
void MeasureApart(const Case& of, const std::string& engine, const Make& make, double step_ms) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);
    try {
      Measure(of, engine, make, step_ms);
    } catch (const std::exception& problem) {
      std::fprintf(stderr, "%s, %s: %s\n", of.name.c_str(), engine.c_str(), problem.what());
    }
    std::fflush(stdout);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (status != 0) {
    std::fprintf(stderr, "%s, %s at %g ms ended with %d\n", of.name.c_str(), engine.c_str(), step_ms, status);
  }
}

int Main(const std::vector<std::string>& arguments) {
  std::vector<double> steps_ms;
  std::vector<std::string> names;
  for (const std::string& argument : arguments) {
    const double step_ms = std::atof(argument.c_str());
    step_ms > 0 ? steps_ms.push_back(step_ms) : names.push_back(argument);
  }
  if (steps_ms.empty()) steps_ms = {1, 2, 5, 10};
  std::vector<std::pair<std::string, Make>> engines = {{"coopdyn", MakeCoopdyn}};
  for (const std::string& integrator : MujocoIntegrators()) {
    engines.push_back(
        {"MuJoCo " + MujocoVersion() + " " + integrator,
         [integrator](const Setup& setup, double step_s) { return MakeMujoco(setup, step_s, integrator); }});
  }
  engines.insert(engines.end(), {{"Bullet 3.24", MakeBullet}, {"DART 6.12", MakeDart}});
  for (const Case& of : Cases()) {
    if (!names.empty() && std::ranges::find(names, of.name) == names.end()) continue;
    for (const auto& [engine, make] : engines) {
      for (const double step_ms : steps_ms) MeasureApart(of, engine, make, step_ms);
    }
  }
  return 0;
}

}  // namespace
}  // namespace coopdyn::frontier

int main(int argc, char** argv) {
  return coopdyn::frontier::Main({argv + 1, argv + argc});
}
