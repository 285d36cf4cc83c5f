// SPDX-License-Identifier: MIT
// The content of a scenario: world, targets, robots, and time mode. Immutable once read; thread-safe.
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

/// How a robot's drive is simulated. Does not affect sensors, modules and commands.
enum class Fidelity { kFull, kRolling, kPlanar };
inline const std::array<std::string, 3> kFidelityWords = {"full", "rolling", "planar"};

// Conversions to and from the words above. Parsing is case-insensitive and returns nullopt for other words.
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

/// [SIMULATION]; missing keys are nullopt.
struct SimulationOptions {
  std::optional<Mode> mode;
  std::optional<Nanoseconds> step;
  std::optional<int> substeps;
  std::uint64_t seed = 1;
  std::uint64_t own_seed = 1;        // the scenario's own seed, regardless of --seed and resets
  std::optional<double> speed;       // ≤ 0: no limit
  std::optional<double> duration_s;  // simulated
  Vector3 g_W{0, 0, -9.81};          // gravity, m/s²
  std::optional<double> watchdog_s;  // default of RobotEntry::watchdog_s
  ControllerChoice supervisor;       // a controller of the world
  bool overlaps = false;             // overlaps at the start are allowed; physics pushes things apart
  /// Names, or prefixes of names ("/my/controller"), of YARP readers for which lockstep waits.
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
  /// Empty (default): in lockstep, wait; in realtime and free, stop the robot if the client had sent `hello`,
  /// else keep its set-points.
  std::optional<LossPolicy> on_disconnect;
  /// Wall clock: in real time the robot stops after its client has been silent for this time; 0: never.
  std::optional<double> watchdog_s;
  Fidelity fidelity = Fidelity::kFull;
  ControllerChoice controller;  // empty: clients drive it
  bool sockets = true;
  SourceLine where;

  /// True if the robot keeps its set-points when its client disconnects.
  bool runs_without_client() const {
    return on_disconnect == LossPolicy::kWait || on_disconnect == LossPolicy::kHold;
  }
  /// The actuator modules that need a command for each lockstep step.
  std::vector<std::string> awaited_modules() const;
  /// True if the robot is a lockstep participant by default.
  bool participates() const { return sync && controller.empty() && !awaited_modules().empty(); }
};

/// The robots of one [SWARM_n]: `count` robots from robots[first], named NAME_1 to NAME_count.
struct SwarmEntry {
  std::string name;
  std::string section;  // swarm1 for [SWARM_1]
  std::size_t first = 0;
  std::size_t count = 0;
  SourceLine where;
};

/// A key of [RANDOM] and its drawn value.
struct RandomKey {
  std::string name;          // BOX_1.size
  std::string distribution;  // as written
  std::string value;
};

/// [TASK]: a task for students. Texts are Markdown.
struct Task {
  static constexpr std::size_t kMaxHints = 20, kMaxTextBytes = 20'000;

  std::string title;
  std::string text;                 // its paragraphs, separated by empty lines
  std::vector<std::string> hints;   // opened one after another
  std::vector<std::string> counts;  // criteria worth points

  bool empty() const { return title.empty() && text.empty() && hints.empty() && counts.empty(); }
};

/// [VIEW]: where pictures of the whole scene are taken from, and the page begins. In the world frame.
struct View {
  /// From where everything is seen: from the right of a robot that faces x and a little behind it, from
  /// above, against x, or along y.
  enum class From { kWhole, kTop, kFront, kSide };
  static inline const std::array<std::string, 4> kWords = {"whole", "top", "front", "side"};

  From from = From::kWhole;
  Vector3 eye_W = Vector3::Zero();  // the camera's place
  std::optional<Vector3> look_W;    // if there: what a camera at eye_W looks at, instead of `from`
};

struct Scenario {
  std::string name;                  // file name without folder and extension; "(text)" if unknown
  std::string file;                  // path as found; empty if by socket, kPipe if by pipe
  std::string text;                  // as read
  WorldModel world;                  // of the [WORLD] file; empty without
  Floor floor;                       // the effective floor
  std::vector<WorldObject> objects;  // the world's, then the scenario's own; ids are index + 1
  std::vector<Target> targets;
  std::vector<PointLight> lights;  // the world's, then the scenario's own
  double ambient_light = 0;        // reading of a light sensor without lamps
  std::vector<RobotEntry> robots;
  std::vector<SwarmEntry> swarms;  // in file order
  std::vector<ScoreEntry> scores;  // in file order
  Task task;
  View view;
  SimulationOptions simulation;
  std::vector<RandomKey> random;    // in file order; drawn anew for each seed
  std::vector<SourceText> sources;  // all other texts, each once
};

/// True if a score counts collisions, which requires contact measurements.
bool CountsCollisions(const Scenario& scenario);

/// A one-line summary for `coopdyn check`, e.g.: 5 robots (coopbot), 12 objects (9 static), 2 targets, floor
/// 20 x 20 m, realtime 10 ms
std::string Summary(const Scenario& scenario);

}  // namespace coopdyn
