// SPDX-License-Identifier: MIT
// What a scenario says: world, targets, robots, and how time runs. Constant once read; any thread.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/base/clock.h"
#include "server/base/diagnostics.h"
#include "server/base/ids.h"
#include "server/model/robot_model.h"
#include "server/model/scores.h"
#include "server/model/world_model.h"

namespace coopdyn {

enum class Mode : int { kRealtime = 0, kLockstep = 1, kFree = 2 };
inline const std::array<std::string, 3> kModeWords = {"realtime", "lockstep", "free"};

/// What happens when a robot is late (on_deadline) or loses its client (on_disconnect).
enum class LossPolicy { kWait, kHold, kStop, kDrop };
inline const std::array<std::string, 4> kLossPolicyWords = {"wait", "hold", "stop", "drop"};

/// How a robot's drive is simulated; sensors, modules and commands are the same.
enum class Fidelity { kFull, kRolling, kPlanar };
inline const std::array<std::string, 3> kFidelityWords = {"full", "rolling", "planar"};

// Their words as above; nothing for another word. Case-insensitive.
const char* ToString(Mode mode);
const char* ToString(LossPolicy policy);
const char* ToString(Fidelity fidelity);
std::optional<Mode> ParseMode(const std::string& word);
std::optional<Fidelity> ParseFidelity(const std::string& word);

inline constexpr Nanoseconds kMinStep = 500'000;         // 0.5 ms
inline constexpr Nanoseconds kMaxStep = 100'000'000;     // 100 ms
inline constexpr Nanoseconds kMaxSubstep = 10'000'000;   // 10 ms
inline constexpr Nanoseconds kDefaultStep = 10'000'000;  // 100 Hz

/// `controller diffuse speed=0.2`: a loaded controller and its options.
struct ControllerChoice {
  std::string name;                                     // empty: none
  std::string file;                                     // the shared object, as found on the search path
  std::vector<std::pair<std::string, double>> options;  // in file order, SI units
  SourceLine where;

  bool empty() const { return name.empty(); }
};

/// [SIMULATION]; what is not said is empty.
struct SimulationOptions {
  std::optional<Mode> mode;
  std::optional<Nanoseconds> step;
  std::optional<int> substeps;
  std::uint64_t seed = 1;
  std::uint64_t own_seed = 1;        // what the scenario says, whatever --seed or a reset has made of it
  std::optional<double> speed;       // ≤ 0: no limit
  std::optional<double> duration_s;  // simulated
  Vector3 g_W{0, 0, -9.81};          // gravity: what falls gains this, m/s²
  std::optional<double> watchdog_s;  // of robots that say nothing else, as RobotEntry::watchdog_s
  ControllerChoice supervisor;       // a controller of the world
  bool overlaps = false;             // what starts inside something is no error: it is pushed out
  /// Names of YARP's readers, or what they begin with ("/my/controller"), for which lockstep waits.
  std::vector<std::string> waits_for;
};

/// [ROBOT_n], or one of a [SWARM_n].
struct RobotEntry {
  RobotId id;
  std::string name;
  std::shared_ptr<const RobotModel> model;
  Pose X_WR;  // of the model's frame
  Color color{0.2, 0.4, 0.9};
  bool sync = true;
  std::vector<std::string> waits_for;  // names of actuator modules; empty: all of them
  std::optional<double> deadline_s;    // wall clock
  LossPolicy on_deadline = LossPolicy::kHold;
  /// Empty, the default: lockstep waits; in realtime and free the robot stops if the client had said `hello`,
  /// else its set-points stay.
  std::optional<LossPolicy> on_disconnect;
  /// Wall clock: in real time a robot stops when its client has been silent for so long; 0: never.
  std::optional<double> watchdog_s;
  Fidelity fidelity = Fidelity::kFull;
  ControllerChoice controller;  // empty: clients drive it
  bool sockets = true;
  SourceLine where;

  /// It keeps its set-points when its client is lost.
  bool goes_on_alone() const {
    return on_disconnect == LossPolicy::kWait || on_disconnect == LossPolicy::kHold;
  }
  /// The actuator modules that must have a command for each step of lockstep.
  std::vector<std::string> awaited_modules() const;
  /// Takes part in lockstep unless told otherwise.
  bool participates() const { return sync && controller.empty() && !awaited_modules().empty(); }
};

/// The robots of one [SWARM_n]: `count` of them from robots[first], called NAME_1 to NAME_count.
struct SwarmEntry {
  std::string name;
  std::string section;  // swarm1 for [SWARM_1]
  std::size_t first = 0;
  std::size_t count = 0;
  SourceLine where;
};

/// A key of [RANDOM], with the value that was drawn for the seed.
struct RandomKey {
  std::string name;          // BOX_1.size
  std::string distribution;  // as written
  std::string value;
};

struct Scenario {
  std::string name;                  // file name without folder and extension; "(text)" if none is known
  std::string file;                  // as found; empty by socket, kPipe by pipe
  std::string text;                  // as read
  WorldModel world;                  // of [WORLD] file; empty without
  Floor floor;                       // in force
  std::vector<WorldObject> objects;  // the world's, then the scenario's own; ids are index + 1
  std::vector<Target> targets;
  std::vector<PointLight> lights;  // the world's, then the scenario's own
  double ambient_light = 0;        // what a light sensor reads without lamps
  std::vector<RobotEntry> robots;
  std::vector<SwarmEntry> swarms;  // in file order
  std::vector<ScoreEntry> scores;  // in file order
  SimulationOptions simulation;
  std::vector<RandomKey> random;    // in file order; drawn anew for each seed
  std::vector<SourceText> sources;  // all but `text`, each once
};

/// Whether a score counts collisions, so that contacts are measured.
bool CountsCollisions(const Scenario& scenario);

/// A scenario in one line, as `coopdyn check` prints it. For example: 5 robots (coopbot), 12 objects (9
/// static), 2 targets, floor 20 x 20 m, realtime 10 ms
std::string Summary(const Scenario& scenario);

}  // namespace coopdyn
