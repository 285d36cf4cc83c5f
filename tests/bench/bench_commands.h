// SPDX-License-Identifier: MIT
// The commands of coopdyn-bench: each adds itself to `bench`. Parsing sets `chosen` to the function that
// measures and returns the exit code. Main thread.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace coopdyn {

/// Robot-steps per second of CPU, without sockets, pictures or pacing.
void AddBenchSwarm(CLI::App& bench, std::function<int()>& chosen);
/// Cost of a step of one type of robot, by phase.
void AddBenchRobot(CLI::App& bench, std::function<int()>& chosen);
/// Rounds per second over sockets. In a round every robot receives its command, the step runs, and every
/// reply arrives.
void AddBenchLockstep(CLI::App& bench, std::function<int()>& chosen);
/// Cost of recording, and the time to seek in, verify and branch from a run.
void AddBenchRecording(CLI::App& bench, std::function<int()>& chosen);

/// Pictures and lidar rays per second, µs of each reading, and a client's latency of a picture.
void AddBenchSensors(CLI::App& bench, std::function<int()>& chosen);

}  // namespace coopdyn
