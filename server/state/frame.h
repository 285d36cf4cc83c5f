// SPDX-License-Identifier: MIT
// One moment of the world, whole. The holder of the step baton makes it, in playback the player. Constant
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

/// A dynamic body; raw numbers as the physics engine holds them, so that a frame restores bit-exactly.
struct BodyState {
  Vector3 p_WB = Vector3::Zero();                         // centre of mass, m
  std::array<double, 4> q_WB{1, 0, 0, 0};                 // w x y z
  std::array<double, 9> R_WB{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major
  Vector3 v_WB = Vector3::Zero();                         // m/s
  Vector3 w_WB = Vector3::Zero();                         // rad/s
  std::uint64_t sleep_counter = 0;                        // kFrozen: exploded, held where it was last sane

  static constexpr std::uint64_t kFrozen = ~std::uint64_t{0};
  bool frozen() const { return sleep_counter == kFrozen; }
  Quaternion orientation() const { return {q_WB[0], q_WB[1], q_WB[2], q_WB[3]}; }
};

/// A driven joint axis; rad, rad/s, N m, or m, m/s, N. Position and velocity are nan in a playback of what
/// was recorded without them.
struct ChannelState {
  double position = 0;  // not wrapped
  double velocity = 0;  // mean of the last step
  double effort =
      std::numeric_limits<double>::quiet_NaN();  // of its motor in the last substep; nan: not measured
  Setpoint setpoint;                             // latched for the step that made this frame
};

/// The position of a channel in frame 0.
double StartOf(const Scene& scene, std::size_t channel);

/// How a joint of a control board is driven, and where on its way it is. rad, s, N m; of a sliding joint m,
/// N. Doubles alone: it is hashed and kept as they lie.
struct JointControl {
  // Set by clients.
  double stiffness = std::numeric_limits<double>::infinity();  // infinite: a servo
  double damping = 0, offset = 0;                              // of the compliance
  double speed = 0, acceleration = 0;                          // of the profile, above 0
  double p = 100, i = 0, d = 0;                                // of the servo: 1/s, 1/s², -
  // The way to a position.
  double start = 0, start_velocity = 0;  // trapezoidal: the velocity is that of the reference now
  double start_acceleration = 0;
  double target = 0;
  double duration_s = 0, elapsed_s = 0;
  double integral = 0;   // of the position error
  double reference = 0;  // in force: where the joint should be; of velocity and effort these

  static constexpr std::size_t kDoubles = 16;
  bool operator==(const JointControl&) const = default;
};
static_assert(sizeof(JointControl) == JointControl::kDoubles * sizeof(double));

/// The drive train of a joint of a control board. The rotor's angle and rate are those of the joint that it
/// would turn without twist. Doubles alone: it is hashed and kept as they lie.
struct DriveTrainState {
  double rotor_rad = 0;  // not wrapped
  double rotor_rad_s = 0;
  double current_a = 0;  // of the last substep
  double energy_j = 0;   // that the motor has drawn since the start

  static constexpr std::size_t kDoubles = 4;
  bool operator==(const DriveTrainState&) const = default;
};
static_assert(sizeof(DriveTrainState) == DriveTrainState::kDoubles * sizeof(double));

/// What a robot broadcasts in one step: up to 8 numbers. count 0: nothing.
struct RobotMessage {
  static constexpr std::size_t kMaxValues = 8;
  std::uint32_t count = 0;
  std::array<double, kMaxValues> values{};
};

/// A broadcast on its way. Who hears it, and when, is up to sensing (range, loss and delay of the models).
struct SentMessage {
  std::uint32_t robot = 0;  // sender, index into scene->robots
  std::uint64_t step = 0;   // that latched it; the frame of that step is the first that can deliver it
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

/// A point where two things touch. The mean over the step that made the frame.
struct Contact {
  ContactEnd a, b;
  Vector3 p_W = Vector3::Zero();
  Vector3 normal_W = Vector3::UnitZ();  // out of b, towards a
  Vector3 force_W = Vector3::Zero();    // of b on a, N
};

/// Values derived from a frame at first use, e.g. by sensing. Freed with the frame.
struct FrameCache {
  virtual ~FrameCache() = default;
};

/// A [SCORE_n] of the scenario.
struct Score {
  double value = 0;  // nan: it cannot be told
  bool met = false;  // its `until`
};

struct Frame;
using FramePtr = std::shared_ptr<const Frame>;

/// The samples of sensors with one rate and delay, oldest first: what they show, then what they will show
/// when it is old enough. These frames have no samples of their own.
using FrameSamples = std::vector<FramePtr>;

struct Frame {
  /// Grows with each load, reset and restore, and whenever playback jumps: steps grow within one.
  std::uint64_t epoch = 0;
  std::uint64_t step = 0;
  std::uint64_t revision = 0;  // grows with edits at rest, 0 again at each new step
  Nanoseconds time = 0;        // simulated
  Nanoseconds step_length = kDefaultStep;
  std::uint64_t seed = 1;         // of noise and placement
  std::uint64_t solver_seed = 0;  // dRandGetSeed after the step
  std::shared_ptr<const Scene> scene;
  std::vector<BodyState> bodies;              // by increasing body id; scene->body_ids
  std::vector<ChannelState> channels;         // as scene->channels
  std::vector<JointControl> controls;         // of the joints of control boards: Channel::control
  std::vector<DriveTrainState> drive_trains;  // of those joints that have one: Channel::drive_train
  std::vector<double> measured;               // for sensors, robot by robot: SceneRobot::first_measured
  std::vector<Contact> contacts;              // if scene->measures_contacts: those that a sensor may need
  std::vector<FrameSamples> samples;          // as scene->clocks; a sample's own: empty
  std::vector<std::uint8_t>
      commanded;  // as scene->actuators: 1 if a client's command came in force with this step
  /// Broadcasts of the last kMessageSteps steps, this one's included, by step, then sender.
  std::vector<SentMessage> messages;
  std::vector<Score> scores;  // as scene->scenario->scores; empty: none are kept
  /// In playback: the hash of the state that was recorded, of which these poses are roundings.
  std::optional<std::uint64_t> recorded_hash;

  /// No message is delayed by more steps than this.
  static constexpr std::uint64_t kMessageSteps = 100;

  double time_s() const { return ToSeconds(time); }

  // Guarded by cache_once: the first reader fills it.
  mutable std::once_flag cache_once;
  mutable std::unique_ptr<FrameCache> cache;
};

/// All that decides how a run goes on: what `save` keeps, a keyframe of a recording holds, and a restore
/// takes. Immutable once published; any thread.
struct SavedState {
  FramePtr frame;                      // exact
  std::vector<std::byte> controllers;  // ControllerDriver::Save(); empty: nothing is loaded
  Mode mode = Mode::kRealtime;         // in force then
  bool paused = false;
  // What edits after the frame's step have changed; a recording has them as inputs instead.
  std::optional<Nanoseconds> step_length;  // of steps to come; empty: as in the frame
  std::vector<Setpoint> setpoints;         // in force, by the scene's channels; empty: likewise
  std::string warning = {};                // lines: what is to be told when it is put in force
  std::vector<double> scores = {};         // ScoreKeeper::Save()
};
using SavedStatePtr = std::shared_ptr<const SavedState>;

/// The state hash (docs/formats.md, "Run files"): XXH3-64. Of a frame in playback: the recorded one.
std::uint64_t StateHash(const Frame& frame);
/// 16 lower-case hex digits.
std::string HashText(std::uint64_t hash);

/// The joints of control boards as a scene begins.
std::vector<JointControl> StartControls(const Scene& scene);
/// The drive trains as a scene begins.
std::vector<DriveTrainState> StartDriveTrains(const Scene& scene);
/// The drive train of a joint of robot `index` (index into the model's joints); null if it has none.
const DriveTrainState* DriveTrainOf(const Frame& frame, int index, int joint);
/// The channels of robot `index`.
std::span<const ChannelState> ChannelsOf(const Frame& frame, int index);
/// The measured values of a sensor of robot `index`; empty in a playback of what was recorded without them.
std::span<const double> MeasuredOf(const Frame& frame, int index, std::size_t sensor);
/// The moment that a sensor of robot `index` shows: `frame` itself, or a sample that it has taken before.
const Frame& SampleOf(const Frame& frame, int index, std::size_t sensor);
FramePtr SampleOf(const FramePtr& frame, int index, std::size_t sensor);
/// Whether robot `index` exploded and is held where it was last sane.
bool IsFrozen(const Frame& frame, int index);
/// The things and robots for which that is so.
std::vector<std::string> FrozenNames(const Frame& frame);
/// Pose of robot `index`'s frame R in the world.
Pose RobotPose(const Frame& frame, int index);
/// Pose of link `link` of robot `index` in the world.
Pose LinkPose(const Frame& frame, int index, int link);
/// Pose of an object, static or dynamic.
Pose ObjectPose(const Frame& frame, const SceneObject& object);

}  // namespace coopdyn
