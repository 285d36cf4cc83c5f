// SPDX-License-Identifier: MIT
// A complete moment of the world. Made by the holder of the step baton, in playback by the player. Constant
// once published; any thread reads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/geometry/shape.h"
#include "server/model/scenario.h"
#include "server/state/scene.h"

namespace coopdyn {

/// A dynamic body. Raw numbers of the physics engine, so a frame restores bit-exactly.
struct BodyState {
  Vector3 p_WB = Vector3::Zero();                         // centre of mass, m
  std::array<double, 4> q_WB{1, 0, 0, 0};                 // w x y z
  std::array<double, 9> R_WB{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major
  Vector3 v_WB = Vector3::Zero();                         // m/s
  Vector3 w_WB = Vector3::Zero();                         // rad/s
  std::uint64_t sleep_counter = 0;                        // kFrozen: exploded, held at its last valid state

  static constexpr std::uint64_t kFrozen = ~std::uint64_t{0};
  bool frozen() const { return sleep_counter == kFrozen; }
  Quaternion orientation() const { return {q_WB[0], q_WB[1], q_WB[2], q_WB[3]}; }
};

/// A driven joint axis, in rad, rad/s, N m, or m, m/s, N. Position and velocity are NaN in a playback whose
/// recording lacks them.
struct ChannelState {
  double position = 0;  // not wrapped
  double velocity = 0;  // mean of the last step
  double effort =
      std::numeric_limits<double>::quiet_NaN();  // of its motor in the last substep; nan: not measured
  Setpoint setpoint;                             // latched for the step that made this frame
};

/// The channel's position in frame 0.
double StartOf(const Scene& scene, std::size_t channel);

/// Control parameters and trajectory state of a control board's joint, in rad, s, N m; for a sliding joint m,
/// N. Doubles only: hashed and stored as they lie in memory.
struct JointControl {
  // Set by clients.
  double stiffness = std::numeric_limits<double>::infinity();  // infinite: a servo
  double damping = 0, offset = 0;                              // of the compliance
  double speed = 0, acceleration = 0;                          // of the profile, above 0
  double p = 100, i = 0, d = 0;                                // of the servo: 1/s, 1/s², -
  // Trajectory to a position.
  double start = 0, start_velocity = 0;  // trapezoidal: the reference's velocity now
  double start_acceleration = 0;
  double target = 0;
  double duration_s = 0, elapsed_s = 0;
  double integral = 0;   // of the position error
  double reference = 0;  // in force: the desired position, velocity or effort

  static constexpr std::size_t kDoubles = 16;
  bool operator==(const JointControl&) const = default;
};
static_assert(sizeof(JointControl) == JointControl::kDoubles * sizeof(double));

/// The drive train of a control board's joint. The rotor's angle and rate are expressed as those of the joint
/// without twist. Doubles only: hashed and stored as they lie in memory.
struct DriveTrainState {
  double rotor_rad = 0;  // not wrapped
  double rotor_rad_s = 0;
  double current_a = 0;  // of the last substep
  double energy_j = 0;   // drawn by the motor since the start

  static constexpr std::size_t kDoubles = 4;
  bool operator==(const DriveTrainState&) const = default;
};
static_assert(sizeof(DriveTrainState) == DriveTrainState::kDoubles * sizeof(double));

/// A robot's broadcast in one step: up to 8 numbers. count 0: none.
struct RobotMessage {
  static constexpr std::size_t kMaxValues = 8;
  std::uint32_t count = 0;
  std::array<double, kMaxValues> values{};
};

/// A broadcast in transit. Sensing decides who receives it, and when (range, loss and delay of the models).
struct SentMessage {
  std::uint32_t robot = 0;  // sender, index into scene->robots
  std::uint64_t step = 0;   // step that latched it; that step's frame is the first that can deliver it
  RobotMessage message;
};

/// One end of a contact: the floor, an object or a part of a robot.
struct ContactEnd {
  std::int32_t object = -1;    // index into scene->objects
  std::int32_t robot = -1;     // index into scene->robots; both -1: the floor
  std::int32_t link = 0;       // of the robot
  std::int32_t collision = 0;  // of the link

  bool operator==(const ContactEnd&) const = default;
};

/// A point where two things touch: the mean over the step that made the frame.
struct Contact {
  ContactEnd a, b;
  Vector3 p_W = Vector3::Zero();
  Vector3 normal_W = Vector3::UnitZ();  // out of b, towards a
  Vector3 force_W = Vector3::Zero();    // of b on a, N
};

/// Values derived from a frame on first use, e.g. by sensing. Freed with the frame.
struct FrameCache {
  virtual ~FrameCache() = default;
};

/// A [SCORE_n] of the scenario.
struct Score {
  double value = 0;  // NaN: undefined
  bool met = false;  // its `until` holds
};

struct Frame;
using FramePtr = std::shared_ptr<const Frame>;

/// The samples of all sensors with the same rate and delay, oldest first: the one shown now, then those shown
/// once old enough. The sample frames contain no samples.
using FrameSamples = std::vector<FramePtr>;

struct Frame {
  /// Grows with each load, reset and restore, and with each jump of a playback: steps grow within an epoch.
  std::uint64_t epoch = 0;
  std::uint64_t step = 0;
  std::uint64_t revision = 0;  // grows with edits between steps; 0 at each new step
  Nanoseconds time = 0;        // simulated
  Nanoseconds step_length = kDefaultStep;
  std::uint64_t seed = 1;         // of noise and placement
  std::uint64_t solver_seed = 0;  // dRandGetSeed after the step
  std::shared_ptr<const Scene> scene;
  std::vector<BodyState> bodies;              // by increasing body id; scene->body_ids
  std::vector<ChannelState> channels;         // as scene->channels
  std::vector<JointControl> controls;         // of the joints of control boards: Channel::control
  std::vector<DriveTrainState> drive_trains;  // of joints that have one: Channel::drive_train
  std::vector<double> measured;               // for sensors, robot by robot: SceneRobot::first_measured
  std::vector<Contact> contacts;              // if scene->measures_contacts: those that sensors may need
  std::vector<FrameSamples> samples;          // as scene->clocks; empty in a sample
  std::vector<std::uint8_t> commanded;  // as scene->actuators: 1 if this step put a client's command in force
  /// Broadcasts of the last kMessageSteps steps, including this one, by step, then sender.
  std::vector<SentMessage> messages;
  std::vector<Score> scores;  // as scene->scenario->scores; empty: none
  /// In playback: the recorded state hash. The recorded poses are rounded.
  std::optional<std::uint64_t> recorded_hash;

  /// Upper limit of message delays, in steps.
  static constexpr std::uint64_t kMessageSteps = 100;

  double time_s() const { return ToSeconds(time); }

  // Guarded by cache_once: filled by the first reader.
  mutable std::once_flag cache_once;
  mutable std::unique_ptr<FrameCache> cache;
};

/// Everything that determines how a run continues: written by `save` and into keyframes, read by a restore.
/// Immutable once published; any thread.
struct SavedState {
  FramePtr frame;                      // exact
  std::vector<std::byte> controllers;  // ControllerDriver::Save(); empty: none loaded
  Mode mode = Mode::kRealtime;         // in force then
  bool paused = false;
  // Changed by edits after the frame's step; a recording stores these as inputs instead.
  std::optional<Nanoseconds> step_length;  // of steps to come; empty: as in the frame
  std::vector<Setpoint> setpoints;         // in force, by the scene's channels; empty: as in the frame
  std::string warning = {};                // lines to report when the state is put in force
  std::vector<double> scores = {};         // ScoreKeeper::Save()
};
using SavedStatePtr = std::shared_ptr<const SavedState>;

/// The state hash (docs/formats.md, "Run files"): XXH3-64. For a frame in playback, the recorded hash.
std::uint64_t StateHash(const Frame& frame);
/// 16 lower-case hex digits.
std::string HashText(std::uint64_t hash);

/// The scene's control-board joints at the start.
std::vector<JointControl> StartControls(const Scene& scene);
/// The scene's drive trains at the start.
std::vector<DriveTrainState> StartDriveTrains(const Scene& scene);
/// The drive train of a joint of robot `index` (index into the model's joints); null if it has none.
const DriveTrainState* DriveTrainOf(const Frame& frame, int index, int joint);
/// The channels of robot `index`.
std::span<const ChannelState> ChannelsOf(const Frame& frame, int index);
/// The measured values of a sensor of robot `index`; empty in a playback whose recording lacks them.
std::span<const double> MeasuredOf(const Frame& frame, int index, std::size_t sensor);
/// The frame that a sensor of robot `index` shows: `frame` itself or an earlier sample.
const Frame& SampleOf(const Frame& frame, int index, std::size_t sensor);
FramePtr SampleOf(const FramePtr& frame, int index, std::size_t sensor);
/// Whether robot `index` has exploded and is held at its last valid state.
bool IsFrozen(const Frame& frame, int index);
/// The names of frozen things and robots.
std::vector<std::string> FrozenNames(const Frame& frame);
/// Pose of robot `index`'s frame R in the world.
Pose RobotPose(const Frame& frame, int index);
/// Pose of link `link` of robot `index` in the world.
Pose LinkPose(const Frame& frame, int index, int link);
/// Pose of an object, static or dynamic.
Pose ObjectPose(const Frame& frame, const SceneObject& object);

}  // namespace coopdyn
