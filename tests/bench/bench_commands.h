// SPDX-License-Identifier: MIT
// The commands of coopdyn-bench: each adds itself to `bench`. Parsing it sets `chosen` to what measures and
// returns the exit code. Main thread.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace coopdyn {

/// How many robot-steps a second of CPU gives, without sockets, pictures or pacing.
void AddBenchSwarm(CLI::App& bench, std::function<int()>& chosen);
/// What a step of one type of robot costs, by phase.
void AddBenchRobot(CLI::App& bench, std::function<int()>& chosen);
/// Rounds per second over sockets. A round: every robot gets its command, the step runs, every reply is
/// there.
void AddBenchLockstep(CLI::App& bench, std::function<int()>& chosen);
/// What recording costs, and how long it takes to find a moment again, to verify the run, and to begin anew.
void AddBenchRecording(CLI::App& bench, std::function<int()>& chosen);

/// Pictures and lidar rays per second, µs of each reading, and how long a client waits for a picture.
void AddBenchSensors(CLI::App& bench, std::function<int()>& chosen);

}  // namespace coopdyn
