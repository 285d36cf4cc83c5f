// SPDX-License-Identifier: MIT
// Drives the robots of a coopdyn daemon from C++; the same names and meaning as in Python and MATLAB.
//
//   auto sim = coopdyn::client::connect();        // this machine, or COOPDYN_SERVER; "labserver:10100"
//   // in a class: connect("labserver", {.seat = "ana", .pin = "7305"}), or COOPDYN_SEAT=ana:7305
//   auto r = sim.robot("robot1");
//   r.set_velocity(0.2, 0.5);                     // m/s, rad/s; left is positive
//   sim.step();                                   // waits for the next step of time
//   auto p = r.get_pose();
//   sim.close();
//
// In lockstep set_velocity does not wait: it is kept (the last wins) until sim.step(), which sends the
// commands of all robots of this sim and waits for the step. In real time it is sent at once, and sim.step()
// waits for the next step. Units: m, rad, s, m/s, rad/s; headings and bearings 0 ahead, left positive, in
// (-pi, pi]. Everything throws Error. If somebody else resets the world or loads a scenario, the next
// reading, command or step throws WorldReset, once. A simulation and its robots belong to one thread.
// Dropping them closes their connections; close() also stops robots.
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

/// Where a robot is and how it moves, in the world frame: m, rad, m/s, rad/s.
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
/// What another robot sent, and where that one is now.
struct Heard {
  int id = 0;
  double distance = 0, bearing = 0;
  std::vector<double> values;
};
/// Where each distance sensor looks, how wide [rad] and how far [m], right to left.
struct Geometry {
  std::vector<double> bearing, opening, max_range;
};
/// Angles [rad] and speeds [rad/s] of the wheels.
struct Wheels {
  double left_angle = 0, right_angle = 0, left_speed = 0, right_speed = 0;
};
/// Limit of the wheel speeds [rad/s], wheel radius and track [m].
struct Limits {
  double max_wheel_speed = 0, wheel_radius = 0, track = 0;
};
/// How far the load has moved the support that carries it, in the robot's frame [m, rad].
struct Support {
  double x = 0, y = 0, angle = 0;
};
/// All readings of a robot in one step; what the robot lacks is empty.
struct Reading {
  double time = 0;
  std::int64_t step = 0;
  std::vector<double> distances;
  std::vector<Target> targets;
  std::optional<Target> target;  // the one that sense() was asked for
  std::optional<Pose> pose;
  std::optional<Wheels> wheels;
  std::optional<double> compass;  // heading [rad]
  std::optional<Support> support;
  std::map<std::string, JointReading> joints;  // by the name of their group
  std::optional<Imu> imu;                      // this and the next: of the first sensor of the kind
  std::optional<Wrench> wrench;
  std::optional<Scan> scan;
  std::vector<Contact> contacts;
  std::vector<double> sonar, infrared, light;
  std::optional<Battery> battery;
  std::optional<Odometry> odometry;
};
/// A raw reply: data without the final two, time [s] and step.
struct Reply {
  std::string text;
  int command = 0;
  std::vector<std::int32_t> params;
  std::vector<double> data;
  double time = 0;
  std::int64_t step = 0;
};
/// A pushed reading: ids and words (colours) for targets, data as the get-command has them.
struct Update {
  std::string module, text;
  double time = 0;
  std::int64_t step = 0;
  std::vector<std::int32_t> params;
  std::vector<double> value;
};
/// Whom the world waits for, why, and since when [s].
struct Awaited {
  std::string robot, why;
  double seconds = 0;
};
/// A camera of snapshot(): points x, y, z [m] in the world; empty = the daemon's choice.
struct View {
  int w = 640, h = 480;
  std::vector<double> eye = {}, look = {};
};

/// What is being recorded: the file's name, the simulated times [s] and steps it holds, the steps that were
/// left out because the disk could not follow, and its size.
struct Recording {
  std::string name;
  double begin_time = 0, end_time = 0;
  std::int64_t steps = 0, lost = 0, bytes = 0;
};
/// A recording that the daemon has: seconds (simulated) and steps are empty if it cannot be read, url is
/// empty if it cannot be copied now.
struct RunFile {
  std::string name;
  std::int64_t bytes = 0;
  std::optional<double> seconds = {};
  std::optional<std::int64_t> steps = {};
  bool recording = false;
  std::string url = {};
};
/// A recording that was ended: its name, and where the daemon's page has it; empty: there is no page.
struct Recorded {
  std::string name, url;
};
/// How a recording is played: its simulated times [s], the one shown, how fast, whether it goes on, begins
/// again at its end, and is still being recorded; and its name.
struct Playback {
  double begin_time = 0, end_time = 0, time = 0, speed = 1;
  bool playing = false, loop = false, growing = false;
  std::string file;
};
/// What a ray meets first: its name (empty: nothing), the point [m] and how far it is [m].
struct Picked {
  std::string name;
  std::array<double, 3> point{};
  double distance = 0;
};
/// A state that the daemon keeps, and its simulated time [s].
struct SavedState {
  std::string name;
  double time = 0;
};

/// One robot. Readings are always those of the newest step.
class Robot {
 public:
  const std::string& name() const;

  /// Forward speed [m/s] and turn rate [rad/s], left is positive. Beyond the limits both are scaled.
  void set_velocity(double v, double w);
  void set_velocity(const std::vector<double>& v_w);  // both in a row of two, as the next
  /// Speeds of the left and right wheel [rad/s].
  void set_wheel_speeds(double l, double r);
  void set_wheel_speeds(const std::vector<double>& l_r);
  void stop();

  Pose get_pose();
  Pose3d get_pose_3d();
  /// Where its front points [rad]: 0 along the world's x, left positive. For robots with a module `compass`;
  /// another compass is read by its module's name.
  double get_compass(const std::string& module = "compass");
  /// By how much the load has moved the support that carries it. For robots with a module `support`.
  Support get_support(const std::string& module = "support");

  // For robots with a module of this type; another of the same type is read by its module's name.
  Imu get_imu(const std::string& module = "imu");
  Wrench get_wrench(const std::string& module = "wrench");
  Scan get_scan(const std::string& module = "lidar");
  std::vector<Contact> get_contacts(const std::string& module = "contact");
  /// Whether each zone of the bumper is pressed, right to left.
  std::vector<bool> get_bumper(const std::string& module = "contact");
  /// What a camera sees, in colour. With a rate it is the camera's last picture, as its `step` says.
  Image get_image(const std::string& module = "camera");
  /// The same as the bytes of a JPEG file.
  std::vector<std::uint8_t> get_jpeg(const std::string& module = "camera");
  Depth get_depth(const std::string& module = "camera");
  Segmentation get_segmentation(const std::string& module = "camera");
  Camera get_camera(const std::string& module = "camera");
  Battery get_battery(const std::string& module = "battery");
  /// How much light each sensor sees.
  std::vector<double> get_light(const std::string& module = "light");
  /// One range per sonar [m]; inf = nothing in range, 0 = nearer than the minimum.
  std::vector<double> get_sonar(const std::string& module = "sonar");
  /// What each infrared sensor puts out, by its curve.
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
  /// Every robot within range. For robots with a module `neighbours`, as the next two.
  std::vector<OtherRobot> get_neighbours();
  /// What is heard in this step.
  std::vector<Heard> get_messages();
  /// Broadcasts one to eight numbers with the next step, to the robots within range; the last message before
  /// the step counts.
  void send_message(const std::vector<double>& values);
  Wheels get_wheels();
  Limits get_limits();

  /// All readings of one step in one round trip; in lockstep, right after sim.step(), those that came with
  /// its reply, without any. With a colour, `target` is the nearest target of it. Of several sensors of a
  /// type it has the first; read the others by name: get_scan("rear_lidar").
  Reading sense(const std::string& x = "");

  /// Its joints of this name: a group of `<coopdyn:group>` in its model, "joints" if it names none. Without a
  /// name the only group. Error 5 if there are several, or none.
  Joints joints(const std::string& group = "");
  /// Its muscles and thrusters. Error 5 if it has none.
  Muscles muscles();
  Thrusters thrusters();
  /// Its channel: all motors and values that its model maps, in one exchange. From then on it drives the
  /// robot alone: what is told its wheels, joints, muscles or thrusters is error 5. Error 5 if it has none.
  Channel channel();

  /// Has the first reading of a module sent every n steps; next() takes them. n = 0 ends it. What is not
  /// taken in time is dropped, the oldest first (64 are kept).
  void subscribe(const std::string& module, int n = 1);
  /// The next pushed reading of one module, or ("") of any subscribed to. Error 11 after `timeout` seconds.
  Update next(const std::string& module = "", double timeout = kNoTimeout_s);

  /// The raw message to one of this robot's modules, e.g. call("motors", "set_velocity", {}, {0.2, 0}).
  Reply call(const std::string& module, const std::string& command, std::vector<std::int32_t> params = {},
             std::vector<double> data = {}, const std::string& text = "", double timeout = kNoTimeout_s);

 private:
  friend class Simulation;
  Robot(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link);
  /// The link to its actuator of this type.
  std::shared_ptr<RobotLink> Actuator(const std::string& type);

  std::shared_ptr<Session> session_;
  std::shared_ptr<RobotLink> link_;
};

struct LaunchOptions;

/// A connection to a daemon: its time and its robots. Made by connect() and launch().
class Simulation {
 public:
  explicit Simulation(std::shared_ptr<Session> session);

  /// Takes a robot, by name or number (from 1), to be driven by this sim. Error 6 if another client owns it.
  /// While a recording is played it is only read, and taken after a branch with the first step or command if
  /// nobody has it.
  Robot robot(const std::string& name);
  Robot robot(int number);
  std::vector<std::string> robots();
  /// Takes robots to be driven together, through one connection: names of swarms or robots, or all that
  /// nobody drives. Error 6 if another client owns one of them, or this sim has driven one singly; then
  /// none is taken.
  Team team(const std::string& name);
  Team team(const std::vector<std::string>& names);
  Team team();

  /// Goes on by n steps; teams keep their speeds. Error 11 after `timeout` seconds. Waiting longer than 2 s
  /// it says once, on stderr, whom for.
  void step(int n = 1, double timeout = kNoTimeout_s);
  /// Simulated time [s] and step number of the newest reply.
  double time() const;
  std::int64_t steps() const;
  /// "realtime", "lockstep" or "free", asked now.
  std::string mode();
  /// Length of a step [s], asked now.
  double dt();

  void run();
  void pause();
  /// Stops every robot, also those of others.
  void stop_all();
  /// Starts again at step 0, with a new seed if one is given, by which [RANDOM] is drawn anew.
  void reset();
  void reset(int seed);
  /// Loads the same scenario file again from disk.
  void reload();
  /// Loads a scenario: a name on the daemon's search path, a file here, or the text of one.
  void load_scenario(const std::string& x);
  void set_mode(const std::string& mode);
  /// Length of a step, 0.0005 to 0.1 s.
  void set_step(double s);
  /// How fast time goes against the wall clock; 0 or less: no limit.
  void set_speed(double x);
  /// The robots that lockstep waits for; empty: as the scenario says.
  void set_participants(const std::vector<std::string>& names = {});
  /// Takes a robot from whoever drives it: closes that program's connection, or unloads its controller.
  void release_robot(const std::string& name);

  // What stands in the world, edited live.
  /// Puts things, robots, targets and lights into the world: sections of a scenario, or a file of such;
  /// returns their names. [BOX_*] takes the next free number; in one line | stands between the lines. Error 5
  /// if it would overlap.
  std::vector<std::string> insert(const std::string& sections);
  /// Takes things, robots, targets or lights out of the world.
  void remove(const std::string& name);
  void remove(const std::vector<std::string>& names);
  /// Puts something elsewhere, at rest: x, y or x, y, z [m]; then a yaw [rad], or a quaternion w, x, y, z,
  /// which need x, y and z. What is not given it keeps. Error 5 if it would overlap.
  void move(const std::string& name, const std::vector<double>& position,
            const std::vector<double>& turn = {});
  /// Changes keys of a thing's section in the scenario: sim.change("BOX_1", {{"color", "red"}, {"mass",
  /// "2"}}).
  void change(const std::string& name, const std::map<std::string, std::string>& keys);
  /// Gives a thing, a robot or a light another name. The modules of a robot get new names, too.
  void rename(const std::string& name, const std::string& new_name);
  /// Takes back the last edit, of whichever client; returns what that concerned. Error 5: there is none.
  std::string undo();
  /// Makes the edit again that undo, or a reset, has taken back last.
  std::string redo();
  /// All that stands in the world now, as JSON (docs/protocol.md).
  std::string world();
  /// Writes the present world as a scenario that loads to the same places; returns the file's name.
  std::string save_scenario(const std::string& file);
  /// What a ray from a point in a direction meets first.
  Picked pick(const std::array<double, 3>& origin, const std::array<double, 3>& direction);

  /// Keeps all that decides how the run goes on, under a name; replaces what is kept under that name.
  void save_state(const std::string& name);
  /// Goes on from a saved state, bit for bit; "start" is where the run began.
  void restore_state(const std::string& name);
  /// The states that can be restored.
  std::vector<SavedState> saved_states();

  /// Records the run from here on, in the daemon's folder; returns the name of the file. Without a name under
  /// run-DATE-TIME. Nothing is overwritten: error 5.
  std::string record(const std::string& name = "");
  /// Ends the recording; returns when its file is closed.
  Recorded stop_recording();
  /// Marks this time in the recording; Run::events() has it.
  void note(const std::string& text);
  /// What is being recorded now.
  std::optional<Recording> recording();
  /// The recordings that the daemon has, newest first.
  std::vector<RunFile> recordings();
  /// Copies a recording from the daemon to `file` (default: of the same name, here) and returns the file's
  /// name. A file called .mat gets the run as MATLAB reads it. What was there is replaced when all has come.
  std::string fetch_run(const std::string& name, const std::string& file = "");

  // Playing a recording: `coopdyn play RUN`.
  /// Which recording is played, and what is shown. Error 5 in a live run, as for the others.
  Playback playback();
  /// Shows the step at this simulated time [s], or the one before it; the nearest end if it lies outside.
  void seek(double time);
  /// Lets the recording go on, at this speed if one is given; -4 to 64 times, below 0 backwards.
  void play(std::optional<double> speed = std::nullopt);
  void set_play_speed(double s);
  /// Goes n recorded steps on, or back if n is below 0, and stands there.
  void skip(int n = 1);
  /// Whether the recording begins again at its end.
  void set_loop(bool on);
  /// Ends the playback: the simulation goes on live from the step shown, or from this simulated time [s], bit
  /// for bit as it did if the inputs are the same.
  void branch(std::optional<double> time = std::nullopt);
  /// Plays a recording of the daemon. The live run is put aside until close_run().
  void open_run(const std::string& name);
  /// Ends the playback: the live run goes on where open_run() put it aside.
  void close_run();

  /// The whole state of the simulation (docs/protocol.md lists the keys).
  Json status();
  /// The hash of the state, 16 hexadecimal digits: equal runs give equal hashes.
  std::string hash();
  /// What the run is worth so far, by the names of the scenario's [SCORE_n]; nan if it cannot be told.
  std::map<std::string, double> scores();
  /// Logs a number under a name: logged(), --summary and the recording have it; Run::logged() reads it there.
  void log(const std::string& name, double value);
  /// The newest number of each name that was logged.
  std::map<std::string, double> logged();
  /// Ends the run, which has reached what it was for; a daemon that was started for one run ends with it.
  void end_run(const std::string& why = "");
  std::vector<Awaited> waiting();
  /// Writes a PNG picture to `file`; returns its name.
  std::string snapshot(const std::string& file, const View& view = {});
  /// The commands of a module, e.g. "/robot1/motors".
  Json describe(const std::string& name);
  std::vector<Module> modules();
  /// The raw message; in lockstep an actuator command is answered after the step.
  Reply call(const std::string& name, const std::string& command, std::vector<std::int32_t> params = {},
             std::vector<double> data = {}, const std::string& text = "", double timeout = kNoTimeout_s);
  /// Writes `stop` to the robots of this sim and frees them. Does not wait.
  void close();

 private:
  friend Simulation launch(const std::string& scenario, const LaunchOptions& options);
  std::shared_ptr<Session> session_;
};

/// Who connects, and how.
struct Options {
  std::string name = {};   // who drives, no spaces; empty: user@host:pid. The same name takes a robot over
  std::string token = {};  // needed from other machines to change the world
  double timeout = 3;      // seconds until connecting gives up
  bool watch = false;      // never drives a robot, only looks on
  /// Of a class (`coopdyn host`), with its PIN, as on your sheet. Neither: COOPDYN_SEAT=ana:7305; an empty
  /// seat: none.
  std::optional<std::string> seat = {};
  std::string pin = {};
};

/// Connects to "HOST", "HOST:PORT" or "PORT" of this machine, or "unix:/PATH", a unix socket; empty:
/// COOPDYN_SERVER, else this machine.
Simulation connect(const std::string& server = "", const Options& options = {});
/// How a daemon of the program's own runs.
struct LaunchOptions {
  std::map<std::string, std::string> set =
      {};  // keys of the scenario with other values, {"SWARM_1.count", "20"}
  std::optional<std::uint64_t> seed = {};
  std::string mode = {};                  // realtime, lockstep, free; empty: as the scenario says
  std::string record = {};                // a file; empty: none
  std::vector<std::string> options = {};  // more words for `coopdyn serve`, {"--no-http"}
  std::string program = {};               // empty: COOPDYN, COOPDYN_BINARY, else coopdyn on the PATH
  double timeout = 60;                    // seconds until it is ready
};

/// Starts a daemon of this program's own, on free ports of this machine, and connects to it. `scenario`: a
/// file, a name or a text of lines. The daemon ends with close(), with the last of the sim and its robots,
/// and with this program, however that ends. Throws Error 7 with what it said if it does not start.
Simulation launch(const std::string& scenario = "classroom", const LaunchOptions& options = {});
/// Walks from the name of the server to a round trip; prints ok, or cause and cure, per line. True if all is
/// ok.
bool doctor(const std::string& server = "", const std::string& token = "");
bool doctor(const std::string& server, const Options& options);

}  // namespace coopdyn::client
