// SPDX-License-Identifier: MIT
// Drives the robots of a coopdyn daemon from C++, with the same names and semantics as in Python and MATLAB.
//
//   auto sim = coopdyn::client::connect();        // this machine, or COOPDYN_SERVER; "labserver:10100"
//   // in a class: connect("labserver", {.seat = "ana", .pin = "7305"}), or COOPDYN_SEAT=ana:7305
//   auto r = sim.robot("robot1");
//   r.set_velocity(0.2, 0.5);                     // m/s, rad/s; left is positive
//   sim.step();                                   // waits for the next step of time
//   auto p = r.get_pose();
//   sim.close();
//
// In lockstep, set_velocity does not wait: the command is kept (the last wins) until sim.step(), which sends
// the commands of all robots of this sim and waits for the step. In real time, the command is sent
// immediately, and sim.step() waits for the next step. Units: m, rad, s, m/s, rad/s; headings and bearings
// are 0 ahead, left positive, in (-pi, pi]. Any function may throw Error. If another client resets the world
// or loads a scenario, the next reading, command or step throws WorldReset, once. A simulation and its robots
// belong to one thread. Destroying them closes their connections; close() also stops the robots.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/actuators.h"
#include "clients/cpp/address.h"
#include "clients/cpp/error.h"
#include "clients/cpp/joints.h"
#include "clients/cpp/json.h"
#include "clients/cpp/sensors.h"
#include "clients/cpp/team.h"

namespace coopdyn::client {

class Session;
struct RobotLink;

/// Pose and velocity of a robot in the world frame: m, rad, m/s, rad/s.
struct Pose {
  double x = 0, y = 0, heading = 0, forward = 0, turn = 0;
};
/// Position [m], quaternion, velocity [m/s] and angular velocity [rad/s] in the world frame.
struct Pose3d {
  double x = 0, y = 0, z = 0, qw = 1, qx = 0, qy = 0, qz = 0;
  double vx = 0, vy = 0, vz = 0, wx = 0, wy = 0, wz = 0;
};
/// Distance [m] and bearing [rad].
struct Bearing {
  double distance = 0, bearing = 0;
};
/// A target as a robot sees it.
struct Target {
  int id = 0;
  std::string colour;
  double distance = 0, bearing = 0;
};
/// Another robot as a robot sees it.
struct OtherRobot {
  int id = 0;
  std::string name;
  double distance = 0, bearing = 0;
};
/// A message from another robot, and where that robot is now.
struct Heard {
  int id = 0;
  double distance = 0, bearing = 0;
  std::vector<double> values;
};
/// Bearing and opening [rad] and maximal range [m] of each distance sensor, right to left.
struct Geometry {
  std::vector<double> bearing, opening, max_range;
};
/// Angles [rad] and speeds [rad/s] of the wheels.
struct Wheels {
  double left_angle = 0, right_angle = 0, left_speed = 0, right_speed = 0;
};
/// Maximal wheel speed [rad/s], wheel radius and track [m].
struct Limits {
  double max_wheel_speed = 0, wheel_radius = 0, track = 0;
};
/// Displacement of the support by its load, in the robot's frame [m, rad].
struct Support {
  double x = 0, y = 0, angle = 0;
};
/// All readings of a robot in one step. Readings that the robot lacks are empty.
struct Reading {
  double time = 0;
  std::int64_t step = 0;
  std::vector<double> distances;
  std::vector<Target> targets;
  std::optional<Target> target;  // requested from sense()
  std::optional<Pose> pose;
  std::optional<Wheels> wheels;
  std::optional<double> compass;  // heading [rad]
  std::optional<Support> support;
  std::map<std::string, JointReading> joints;  // by group name
  std::optional<Imu> imu;                      // this and the following: the first sensor of the type
  std::optional<Wrench> wrench;
  std::optional<Scan> scan;
  std::vector<Contact> contacts;
  std::vector<double> sonar, infrared, light;
  std::optional<Battery> battery;
  std::optional<Odometry> odometry;
};
/// A raw reply. `data` lacks the final two values, which are in `time` [s] and `step`.
struct Reply {
  std::string text;
  int command = 0;
  std::vector<std::int32_t> params;
  std::vector<double> data;
  double time = 0;
  std::int64_t step = 0;
};
/// A pushed reading: data as in the get command's reply; for targets also their ids and (`text`) colours.
struct Update {
  std::string module, text;
  double time = 0;
  std::int64_t step = 0;
  std::vector<std::int32_t> params;
  std::vector<double> value;
};
/// A robot that the world waits for, why, and for how long [s].
struct Awaited {
  std::string robot, why;
  double seconds = 0;
};
/// The camera of snapshot(): points x, y, z [m] in the world; empty: chosen by the daemon.
struct View {
  int w = 640, h = 480;
  std::vector<double> eye = {}, look = {};
};

/// The recording in progress: the file's name, its simulated times [s], its steps, the steps lost because the
/// disk was too slow, and its size.
struct Recording {
  std::string name;
  double begin_time = 0, end_time = 0;
  std::int64_t steps = 0, lost = 0, bytes = 0;
};
/// A recording on the daemon. Seconds (simulated) and steps are empty if it cannot be read, url is empty if
/// it cannot be downloaded now.
struct RunFile {
  std::string name;
  std::int64_t bytes = 0;
  std::optional<double> seconds = {};
  std::optional<std::int64_t> steps = {};
  bool recording = false;
  std::string url = {};
};
/// A completed recording: its name, and its URL on the daemon's page; empty: the daemon has no page.
struct Recorded {
  std::string name, url;
};
/// The state of a playback: the recording's first and last simulated time [s], the time shown, the speed,
/// whether it is playing, loops, and is still being recorded, and the recording's name.
struct Playback {
  double begin_time = 0, end_time = 0, time = 0, speed = 1;
  bool playing = false, loop = false, growing = false;
  std::string file;
};
/// The first hit of a ray: its name (empty: no hit), the point [m] and its distance [m].
struct Picked {
  std::string name;
  std::array<double, 3> point{};
  double distance = 0;
};
/// A state saved on the daemon, and its simulated time [s].
struct SavedState {
  std::string name;
  double time = 0;
};

/// One robot. Readings always belong to the newest step.
class Robot {
 public:
  const std::string& name() const;

  /// Forward speed [m/s] and turn rate [rad/s], left is positive. Beyond the limits both are scaled.
  void set_velocity(double v, double w);
  void set_velocity(const std::vector<double>& v_w);  // {v, w}
  /// Speeds of the left and right wheel [rad/s].
  void set_wheel_speeds(double l, double r);
  void set_wheel_speeds(const std::vector<double>& l_r);
  void stop();

  Pose get_pose();
  Pose3d get_pose_3d();
  /// The robot's heading [rad]: 0 along the world's x, left positive. For robots with a module `compass`;
  /// pass the module's name for another compass.
  double get_compass(const std::string& module = "compass");
  /// The displacement of the support by its load. For robots with a module `support`.
  Support get_support(const std::string& module = "support");

  // For robots with a module of this type; pass the module's name for another of the same type.
  Imu get_imu(const std::string& module = "imu");
  Wrench get_wrench(const std::string& module = "wrench");
  Scan get_scan(const std::string& module = "lidar");
  std::vector<Contact> get_contacts(const std::string& module = "contact");
  /// Whether each zone of the bumper is pressed, right to left.
  std::vector<bool> get_bumper(const std::string& module = "contact");
  /// A camera's colour picture. If the camera has a rate, its latest picture, taken at `step`.
  Image get_image(const std::string& module = "camera");
  /// The same as the bytes of a JPEG file.
  std::vector<std::uint8_t> get_jpeg(const std::string& module = "camera");
  Depth get_depth(const std::string& module = "camera");
  Segmentation get_segmentation(const std::string& module = "camera");
  Camera get_camera(const std::string& module = "camera");
  Battery get_battery(const std::string& module = "battery");
  /// The brightness that each light sensor measures.
  std::vector<double> get_light(const std::string& module = "light");
  /// One range per sonar [m]; inf = nothing in range, 0 = nearer than the minimum.
  std::vector<double> get_sonar(const std::string& module = "sonar");
  /// The output of each infrared sensor, by its curve.
  std::vector<double> get_infrared(const std::string& module = "infrared");
  Odometry get_odometry(const std::string& module = "odometry");

  /// One range per sensor [m], right to left, from the surface of the robot; inf = nothing there.
  std::vector<double> get_distances();
  Geometry get_geometry();
  std::vector<Target> get_targets();
  /// The nearest target of a colour, or the target with an id.
  Bearing get_target(const std::string& x);
  Bearing get_target(int x);
  std::vector<OtherRobot> get_robots();
  /// All robots within range. This and the next two: for robots with a module `neighbours`.
  std::vector<OtherRobot> get_neighbours();
  /// The messages received in this step.
  std::vector<Heard> get_messages();
  /// Broadcasts one to eight numbers with the next step to the robots within range. The last message before
  /// the step wins.
  void send_message(const std::vector<double>& values);
  Wheels get_wheels();
  Limits get_limits();

  /// All readings of one step in one round trip; in lockstep, directly after sim.step(), without one, because
  /// the step's reply carried them. With a colour, `target` is the nearest target of that colour. Has the
  /// first sensor of each type; read others by name: get_scan("rear_lidar").
  Reading sense(const std::string& x = "");

  /// A group of joints: a `<coopdyn:group>` of the robot's model, or "joints" if the model names none.
  /// Without a name, the only group. Error 5 if there are several, or none.
  Joints joints(const std::string& group = "");
  /// The robot's muscles and thrusters. Error 5 if it has none.
  Muscles muscles();
  Thrusters thrusters();
  /// The robot's channel: exchanges all motors and values that the model maps at once. From then on only the
  /// channel drives the robot: commands to its wheels, joints, muscles or thrusters are error 5. Error 5 if
  /// the robot has no channel.
  Channel channel();

  /// Subscribes to a module's first reading every n steps; next() returns them. n = 0 unsubscribes. Up to 64
  /// readings are queued; then the oldest is dropped.
  void subscribe(const std::string& module, int n = 1);
  /// The next pushed reading of one module, or ("") of any subscription. Error 11 after `timeout` seconds.
  Update next(const std::string& module = "", double timeout = kNoTimeout_s);

  /// Sends a raw message to one of this robot's modules, e.g. call("motors", "set_velocity", {}, {0.2, 0}).
  Reply call(const std::string& module, const std::string& command, std::vector<std::int32_t> params = {},
             std::vector<double> data = {}, const std::string& text = "", double timeout = kNoTimeout_s);

 private:
  friend class Simulation;
  Robot(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link);
  /// The link to the robot's actuator of this type.
  std::shared_ptr<RobotLink> Actuator(const std::string& type);

  std::shared_ptr<Session> session_;
  std::shared_ptr<RobotLink> link_;
};

struct LaunchOptions;

/// A connection to a daemon: controls its time and its robots. Made by connect() and launch().
class Simulation {
 public:
  explicit Simulation(std::shared_ptr<Session> session);

  /// Claims a robot, by name or number (from 1), for this sim to drive. Error 6 if another client owns it.
  /// While a recording is played, the robot can only be read; after a branch, the first step or command
  /// claims it if it is free.
  Robot robot(const std::string& name);
  Robot robot(int number);
  std::vector<std::string> robots();
  /// Claims robots to be driven together through one connection: names of swarms or robots, or all free
  /// robots. Error 6 if another client owns one of them, or if this sim has driven one singly; then no robot
  /// is claimed.
  Team team(const std::string& name);
  Team team(const std::vector<std::string>& names);
  Team team();

  /// Runs n steps; teams keep their speeds. Error 11 after `timeout` seconds. After 2 s of waiting, reports
  /// once on stderr which robots the world waits for.
  void step(int n = 1, double timeout = kNoTimeout_s);
  /// Simulated time [s] and step number of the newest reply.
  double time() const;
  std::int64_t steps() const;
  /// "realtime", "lockstep" or "free". Queries the daemon.
  std::string mode();
  /// Length of a step [s]. Queries the daemon.
  double dt();

  void run();
  void pause();
  /// Stops all robots, including those of other clients.
  void stop_all();
  /// Restarts at step 0; with a seed, also draws [RANDOM] anew from it.
  void reset();
  void reset(int seed);
  /// Reloads the scenario file from disk.
  void reload();
  /// Loads a scenario: a name on the daemon's search path, a local file, or the text of a scenario.
  void load_scenario(const std::string& x);
  void set_mode(const std::string& mode);
  /// Length of a step, 0.0005 to 0.1 s.
  void set_step(double s);
  /// Sets the real-time factor; 0 or less: no limit.
  void set_speed(double x);
  /// Sets the participants, the robots that lockstep waits for; empty: those of the scenario.
  void set_participants(const std::vector<std::string>& names = {});
  /// Frees a robot: closes the connection of the program that drives it, or unloads its controller.
  void release_robot(const std::string& name);

  // Live edits of the world.
  /// Inserts things, robots, targets and lights: sections of a scenario, or a file of sections. Returns their
  /// names. [BOX_*] uses the next free number; a text in one line has | between lines. Error 5 if they would
  /// overlap.
  std::vector<std::string> insert(const std::string& sections);
  /// Removes things, robots, targets or lights.
  void remove(const std::string& name);
  void remove(const std::vector<std::string>& names);
  /// Moves an object and stops it: `position` is x, y or x, y, z [m]; `turn` is a yaw [rad] or a quaternion
  /// w, x, y, z, and needs x, y and z. Omitted components stay unchanged. Error 5 if it would overlap.
  void move(const std::string& name, const std::vector<double>& position,
            const std::vector<double>& turn = {});
  /// Changes keys of a thing's section in the scenario: sim.change("BOX_1", {{"color", "red"}, {"mass",
  /// "2"}}).
  void change(const std::string& name, const std::map<std::string, std::string>& keys);
  /// Renames a thing, a robot (including its modules) or a light.
  void rename(const std::string& name, const std::string& new_name);
  /// Undoes the last edit, by any client; returns the object concerned. Error 5 if there is no edit.
  std::string undo();
  /// Redoes the edit that undo() or a reset undid last.
  std::string redo();
  /// All present objects of the world, as JSON (docs/protocol.md).
  std::string world();
  /// Writes the present world, with all poses, as a scenario; returns the file's name.
  std::string save_scenario(const std::string& file);
  /// The first hit of a ray from a point in a direction.
  Picked pick(const std::array<double, 3>& origin, const std::array<double, 3>& direction);

  /// Saves the complete state of the simulation under a name; replaces an older state of that name.
  void save_state(const std::string& name);
  /// Continues from a saved state, bit for bit; "start" is the start of the run.
  void restore_state(const std::string& name);
  /// The states that can be restored.
  std::vector<SavedState> saved_states();

  /// Starts recording into the daemon's folder; returns the file's name. The default name is run-DATE-TIME.
  /// Error 5 if the file exists.
  std::string record(const std::string& name = "");
  /// Stops the recording; returns once its file is closed.
  Recorded stop_recording();
  /// Adds a note to the recording at the present time; Run::events() returns it.
  void note(const std::string& text);
  /// The recording in progress.
  std::optional<Recording> recording();
  /// The daemon's recordings, newest first.
  std::vector<RunFile> recordings();
  /// Downloads a recording to `file` (default: its own name, in the current folder) and returns the file's
  /// name. For a file *.mat the daemon converts the run to MATLAB's format. An existing file is replaced once
  /// the download is complete.
  std::string fetch_run(const std::string& name, const std::string& file = "");

  // Playing a recording: `coopdyn play RUN`.
  /// The state of the playback. This and the following throw Error 5 in a live run.
  Playback playback();
  /// Shows the last step up to a simulated time [s], clamped to the recording.
  void seek(double time);
  /// Plays on, at `speed` if given: -4 to 64; negative plays backwards.
  void play(std::optional<double> speed = std::nullopt);
  void set_play_speed(double s);
  /// Skips n recorded steps forward, or back if n is negative, and pauses there.
  void skip(int n = 1);
  /// Whether the playback restarts at the recording's end.
  void set_loop(bool on);
  /// Ends the playback: the simulation continues live from the step shown, or from a simulated time [s]. With
  /// the same inputs it repeats the recorded run bit for bit.
  void branch(std::optional<double> time = std::nullopt);
  /// Plays a recording of the daemon. Suspends the live run until close_run().
  void open_run(const std::string& name);
  /// Ends the playback and resumes the live run that open_run() suspended.
  void close_run();

  /// The status of the simulation (docs/protocol.md lists the keys).
  Json status();
  /// The hash of the state, 16 hexadecimal digits: equal runs give equal hashes.
  std::string hash();
  /// The present scores of the run, by the names of the scenario's [SCORE_n]; nan: undefined.
  std::map<std::string, double> scores();
  /// Logs a number under a name: appears in logged(), in --summary and in the recording (Run::logged()).
  void log(const std::string& name, double value);
  /// The newest logged number of each name.
  std::map<std::string, double> logged();
  /// Ends the run because its purpose is achieved; a daemon that was started for one run exits.
  void end_run(const std::string& why = "");
  std::vector<Awaited> waiting();
  /// Writes a PNG picture to `file`; returns its name.
  std::string snapshot(const std::string& file, const View& view = {});
  /// The description of a module's commands, e.g. of "/robot1/motors".
  Json describe(const std::string& name);
  std::vector<Module> modules();
  /// Sends a raw message; in lockstep, the reply to an actuator command arrives after the step.
  Reply call(const std::string& name, const std::string& command, std::vector<std::int32_t> params = {},
             std::vector<double> data = {}, const std::string& text = "", double timeout = kNoTimeout_s);
  /// Sends `stop` to the robots of this sim and frees them. Does not wait for a step.
  void close();

 private:
  friend Simulation launch(const std::string& scenario, const LaunchOptions& options);
  std::shared_ptr<Session> session_;
};

/// The client's identity, and how it connects.
struct Options {
  std::string name = {};   // no spaces; empty: user@host:pid. A client of the same name takes over robots
  std::string token = {};  // needed from other machines to change the world
  double timeout = 3;      // of connecting [s]
  bool watch = false;      // read-only: never drives a robot
  /// Of a class (`coopdyn host`), with its PIN, as on your sheet. Neither: COOPDYN_SEAT=ana:7305; an empty
  /// seat: none.
  std::optional<std::string> seat = {};
  std::string pin = {};
};

/// Connects to "HOST", "HOST:PORT", "PORT" (of this machine), or "unix:/PATH" (a unix socket); empty:
/// COOPDYN_SERVER, else this machine.
Simulation connect(const std::string& server = "", const Options& options = {});
/// Options of launch().
struct LaunchOptions {
  std::map<std::string, std::string> set = {};  // overrides of the scenario's values, {"SWARM_1.count", "20"}
  std::optional<std::uint64_t> seed = {};
  std::string mode = {};                  // realtime, lockstep, free; empty: the scenario's
  std::string record = {};                // file to record to; empty: none
  std::vector<std::string> options = {};  // further arguments of `coopdyn serve`, {"--no-http"}
  std::string program = {};               // empty: COOPDYN, COOPDYN_BINARY, else coopdyn on the PATH
  double timeout = 60;                    // of the start [s]
};

/// Starts a private daemon on free ports of this machine and connects to it. `scenario`: a file, a name or
/// the text of a scenario. The daemon exits on close(), when the sim and all its robots are destroyed, and
/// when this program exits or crashes. Throws Error 7 with the daemon's output if it does not start.
Simulation launch(const std::string& scenario = "classroom", const LaunchOptions& options = {});
/// Checks the connection from the server's name to a round trip; prints ok, or cause and cure, per line.
/// True if all checks pass.
bool doctor(const std::string& server = "", const std::string& token = "");
bool doctor(const std::string& server, const Options& options);

}  // namespace coopdyn::client
