// SPDX-License-Identifier: MIT
#include <algorithm>
#include <iostream>
#include <span>
#include <utility>

#include "clients/cpp/coopdyn_client.h"
#include "clients/cpp/sensor_values.h"
#include "clients/cpp/session.h"
#include "clients/cpp/words.h"
#include "protocol/command_ids.h"

namespace coopdyn::client {
namespace {

constexpr std::size_t kMaxMessage = 8;
constexpr double kLabelsLive_s = 0.5;  // lifetime of cached ids and colours of targets

/// The data of a reply without the final two. Throws Error 7 if they are fewer than `count`.
std::vector<double> Values(const Message& reply, std::size_t count) {
  Require(reply, 0, count);
  return {reply.data.begin(), reply.data.end() - 2};
}

/// Decodes sightings: ids, names or colours, distances and bearings.
template <class T>
std::vector<T> Seen(const Message& reply) {
  const std::vector<std::string> words = Words(reply.text);
  const std::size_t count = std::min(reply.params.size(), words.size());
  const std::vector<double> d = Values(reply, 2 * count);
  std::vector<T> seen;
  for (std::size_t i = 0; i < count; ++i) seen.push_back({reply.params[i], words[i], d[2 * i], d[2 * i + 1]});
  return seen;
}

/// Removes and returns the first `least` + `more` numbers of `rest`. Throws Error 7 if there are fewer.
std::span<const double> TakeFirst(std::span<const double>& rest, std::size_t least, std::int32_t more) {
  const std::size_t count = least + static_cast<std::size_t>(std::max(0, more));
  if (count > rest.size()) throw Error(7, "a reply of the daemon has too few values");
  const std::span<const double> first = rest.first(count);
  rest = rest.subspan(count);
  return first;
}

/// @pre five numbers
Pose ToPose(std::span<const double> d) {
  return {d[0], d[1], d[2], d[3], d[4]};
}

Target Choose(const std::vector<Target>& targets, const std::string& colour) {
  const Target* nearest = nullptr;
  std::string all;
  for (const Target& t : targets) {
    all += (all.empty() ? "" : ", ") + t.colour;
    if (t.colour == colour && (nearest == nullptr || t.distance < nearest->distance)) nearest = &t;
  }
  if (nearest == nullptr)
    throw Error(10, "there is no target '" + colour + "'; there are: " + (all.empty() ? "none" : all));
  return *nearest;
}

}  // namespace

Robot::Robot(std::shared_ptr<Session> session, std::shared_ptr<RobotLink> link)
    : session_(std::move(session)), link_(std::move(link)) {}

const std::string& Robot::name() const {
  return link_->robot;
}

void Robot::set_velocity(double v, double w) {
  link_->Actuate(command::kSetVelocity, {Finite(v, "v [m/s]"), Finite(w, "w [rad/s]")});
}

void Robot::set_velocity(const std::vector<double>& v_w) {
  if (v_w.size() != 2)
    throw Error(3, "set_velocity takes v [m/s] and w [rad/s]: write r.set_velocity(0.2, 0.5)");
  set_velocity(v_w[0], v_w[1]);
}

void Robot::set_wheel_speeds(const std::vector<double>& l_r) {
  if (l_r.size() != 2)
    throw Error(3, "set_wheel_speeds takes l [rad/s] and r [rad/s]: write r.set_wheel_speeds(2, 3)");
  set_wheel_speeds(l_r[0], l_r[1]);
}

void Robot::set_wheel_speeds(double l, double r) {
  link_->Actuate(command::kSetWheelSpeeds, {Finite(l, "l [rad/s]"), Finite(r, "r [rad/s]")});
}

void Robot::stop() {
  link_->Actuate(command::kStop);
}

Pose Robot::get_pose() {
  return ToPose(Values(link_->Read("pose", {command::kGetPose}), 5));
}

Pose3d Robot::get_pose_3d() {
  const std::vector<double> d = Values(link_->Read("pose", {command::kGetPose3d}), 13);
  return {d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7], d[8], d[9], d[10], d[11], d[12]};
}

std::vector<double> Robot::get_distances() {
  return Values(link_->Read("distance", {command::kGetDistances}), 0);
}

double Robot::get_compass(const std::string& module) {
  return Values(link_->Read(module, {command::kGetCompass}), 1)[0];
}

Support Robot::get_support(const std::string& module) {
  const std::vector<double> d = Values(link_->Read(module, {command::kGetSupport}), 3);
  return {d[0], d[1], d[2]};
}

Geometry Robot::get_geometry() {
  const std::vector<double> d = Values(link_->Read("distance", {command::kGetGeometry}), 0);
  Geometry geometry;
  for (std::size_t i = 0; i + 2 < d.size(); i += 3) {
    geometry.bearing.push_back(d[i]);
    geometry.opening.push_back(d[i + 1]);
    geometry.max_range.push_back(d[i + 2]);
  }
  return geometry;
}

std::vector<Target> Robot::get_targets() {
  return Seen<Target>(link_->Read("target", {command::kGetTargets}));
}

Bearing Robot::get_target(const std::string& x) {
  if (x.empty())
    throw Error(3, "a target is a colour or an id: write r.get_target(\"red\") or r.get_target(1)");
  const std::vector<double> d = Values(link_->Read("target", {.command = command::kGetTarget, .text = x}), 2);
  return {d[0], d[1]};
}

Bearing Robot::get_target(int x) {
  const std::vector<double> d = Values(link_->Read("target", {command::kGetTarget, {x}}), 2);
  return {d[0], d[1]};
}

std::vector<OtherRobot> Robot::get_robots() {
  return Seen<OtherRobot>(link_->Read("target", {command::kGetRobots}));
}

std::vector<OtherRobot> Robot::get_neighbours() {
  return Seen<OtherRobot>(link_->Read("neighbours", {command::kGetNeighbours}));
}

std::vector<Heard> Robot::get_messages() {
  const Message reply = link_->Read("neighbours", {command::kGetMessages});
  const std::vector<double> values = Values(reply, 0);
  std::span<const double> rest(values);
  std::vector<Heard> messages;
  for (std::size_t i = 0; i + 1 < reply.params.size(); i += 2) {
    const std::span<const double> d = TakeFirst(rest, 2, reply.params[i + 1]);
    messages.push_back({reply.params[i], d[0], d[1], {d.begin() + 2, d.end()}});
  }
  return messages;
}

void Robot::send_message(const std::vector<double>& values) {
  if (values.empty() || values.size() > kMaxMessage)
    throw Error(3, "a message has 1 to 8 numbers, not " + std::to_string(values.size()));
  for (const double value : values) Finite(value, "a value of a message");
  session_->RequireDriving();
  link_->Read("neighbours", {.command = command::kSendMessage, .data = values});
}

Wheels Robot::get_wheels() {
  const std::vector<double> d = Values(link_->Read("motors", {command::kGetWheels}), 4);
  return {d[0], d[1], d[2], d[3]};
}

Limits Robot::get_limits() {
  const std::vector<double> d = Values(link_->Read("motors", {command::kGetLimits}), 3);
  return {d[0], d[1], d[2]};
}

Reading Robot::sense(const std::string& x) {
  const Message reply = link_->Sense();
  const std::vector<double> values = Values(reply, 0);
  std::span<const double> rest(values), seen;
  Reading reading;
  reading.time = TimeOf(reply);
  reading.step = StepOf(reply);
  for (std::size_t i = 0; i < link_->attached.size() && i + 1 < reply.params.size(); ++i) {
    const std::span<const double> part = TakeFirst(rest, 0, reply.params[i + 1]);
    const std::string& module = link_->attached[i];
    if (module == "distance") {
      reading.distances.assign(part.begin(), part.end());
    } else if (module == "pose" && part.size() >= 5) {
      reading.pose = ToPose(part);
    } else if (module == "motors" && part.size() >= 4) {
      reading.wheels = Wheels{part[0], part[1], part[2], part[3]};
    } else if (module == "compass" && !part.empty()) {
      reading.compass = part[0];
    } else if (module == "support" && part.size() >= 3) {
      reading.support = Support{part[0], part[1], part[2]};
    } else if (module == "lidar" && !part.empty()) {
      reading.scan = ToScan(*link_, module, part);
    } else if (module == "imu" && part.size() >= 10) {
      reading.imu = ToImu(part);
    } else if (module == "wrench" && part.size() >= 6) {
      reading.wrench = ToWrench(part);
    } else if (module == "contact") {
      reading.contacts = ToContacts(part);
    } else if (module == "sonar") {
      reading.sonar.assign(part.begin(), part.end());
    } else if (module == "infrared") {
      reading.infrared.assign(part.begin(), part.end());
    } else if (module == "light") {
      reading.light.assign(part.begin(), part.end());
    } else if (module == "battery" && part.size() >= 3) {
      reading.battery = ToBattery(part);
    } else if (module == "odometry" && part.size() >= 5) {
      reading.odometry = ToOdometry(part);
    } else if (module.starts_with(kGroup)) {
      JointReading& joints = reading.joints[module.substr(kGroup.size())];
      for (std::size_t k = 0; k + 2 < part.size(); k += 3) {
        joints.position.push_back(part[k]);
        joints.velocity.push_back(part[k + 1]);
        joints.effort.push_back(part[k + 2]);
      }
    } else if (module == "target") {
      seen = part;
    }
  }
  const std::size_t seen_count = seen.size() / 2;
  // Ids and colours change only with a reset, load or edit: query them again if the step did not advance, if
  // their number changed, or after kLabelsLive_s.
  const Deadline now = Clock::now();
  const double step = reply.data.back();
  if (seen_count > 0 &&
      (step <= link_->labels_step || now > link_->labels_until || link_->ids.size() != seen_count)) {
    link_->ids.clear();
    link_->colours.clear();
    for (const Target& t : get_targets()) {
      link_->ids.push_back(t.id);
      link_->colours.push_back(t.colour);
    }
  }
  link_->labels_step = step;
  link_->labels_until = After(kLabelsLive_s, now);
  for (std::size_t i = 0; i < std::min(seen_count, link_->ids.size()); ++i)
    reading.targets.push_back({link_->ids[i], link_->colours[i], seen[2 * i], seen[2 * i + 1]});
  if (!x.empty()) reading.target = Choose(reading.targets, x);
  return reading;
}

Joints Robot::joints(const std::string& group) {
  session_->RequireOpen();
  if (link_->lost && link_->lost->code() == 10) throw Error(*link_->lost);
  const std::vector<std::string> groups = session_->GroupsOf(name());
  if (groups.empty()) throw Error(5, name() + " has no joints with motors of their own");
  if (group.empty() && groups.size() > 1)
    throw Error(5, name() + " has several groups of joints; write r.joints(\"" + groups[0] +
                       "\"); there are: " + ListOf(groups));
  const std::string& wanted = group.empty() ? groups[0] : group;
  if (std::find(groups.begin(), groups.end(), wanted) != groups.end()) {
    if (link_->actuator == wanted) return Joints(session_, link_);
    for (const auto& other : link_->others) {
      if (other->actuator == wanted) return Joints(session_, other);
    }
  }
  throw Error(10, name() + " has no joints '" + wanted + "'; " + Nearest(wanted, groups) +
                      "there are: " + ListOf(groups));
}

std::shared_ptr<RobotLink> Robot::Actuator(const std::string& type) {
  session_->RequireOpen();
  if (link_->lost && link_->lost->code() == 10) throw Error(*link_->lost);
  if (link_->type == type) return link_;
  for (const auto& other : link_->others) {
    if (other->type == type) return other;
  }
  std::vector<std::string> names;
  for (const auto& [module, its_type] : session_->ActuatorsOf(name())) {
    if (its_type == type && type == kChannel) {
      session_->Add(link_->TakeChannel(module));
      return link_->others.back();
    }
    names.push_back(module);
  }
  throw Error(5, name() + " has no " + type + "; its actuators: " + ListOf(names));
}

Muscles Robot::muscles() {
  return Muscles(session_, Actuator("muscles"));
}

Thrusters Robot::thrusters() {
  return Thrusters(session_, Actuator("thrusters"));
}

Channel Robot::channel() {
  return Channel(Actuator(kChannel));
}

void Robot::subscribe(const std::string& module, int n) {
  session_->RequireOpen();
  link_->pushers.erase(module);
  if (n == 0) return;
  if (n < 0) throw Error(4, "n must be at least 1, or 0 to end the subscription");
  auto connection = std::make_unique<Connection>(session_->address(), link_->Path(module), false);
  try {
    connection->Open();
  } catch (const Error& e) {
    if (e.code() != kNoSuchName || !link_->FindAgain(module, *connection)) throw;
    connection->Open();
  }
  connection->Ask({command::kSubscribe, {n}});
  link_->pushers[module] = std::move(connection);
}

Update Robot::next(const std::string& module, double timeout) {
  if (link_->pushers.empty() || (!module.empty() && !link_->pushers.contains(module)))
    throw Error(5, "nothing is subscribed to; write r.subscribe(\"distance\") first");
  const Deadline deadline = After(timeout);
  Deadline notice_at = After(kNoticeAfter_s);
  while (true) {
    std::vector<int> fds;
    for (auto& [name, connection] : link_->pushers) {
      if (!module.empty() && name != module) continue;
      try {
        if (connection->pushes.empty()) connection->TryRead();
      } catch (const Closed& e) {
        if (e.by_load()) throw session_->NewWorld(kLoad);
        throw;
      }
      if (connection->pushes.empty()) {
        fds.push_back(connection->fd());
        continue;
      }
      const Message pushed = std::move(connection->pushes.front());
      connection->pushes.pop_front();
      const std::vector<double> value = Values(pushed, 0);
      return {name, pushed.text, TimeOf(pushed), StepOf(pushed), pushed.params, value};
    }
    const Deadline now = Clock::now();
    if (now >= deadline)
      throw Error(11, "no reading was pushed within the timeout; " + session_->DescribeWait());
    if (now >= notice_at) {
      const std::string whom = session_->DescribeWait(true);
      notice_at = whom.empty() ? After(kNoticeAfter_s, now) : Deadline::max();
      if (!whom.empty()) std::cerr << "coopdyn: " << whom << std::endl;
    }
    WaitReadable(fds, SecondsUntil(std::min({deadline, notice_at, After(3600, now)}), now));
  }
}

Reply Robot::call(const std::string& module, const std::string& command, std::vector<std::int32_t> params,
                  std::vector<double> data, const std::string& text, double timeout) {
  session_->RequireOpen();
  if (link_->modules.empty()) link_->modules = session_->ModulesOf(name());
  return Simulation(session_).call(link_->Path(module), command, std::move(params), std::move(data), text,
                                   timeout);
}

}  // namespace coopdyn::client
